#include "groups.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <sdm/error.h>
#include <sdm/map_files.h>
#include <sdm/mesh_files.h>
#include <sdm/places.h>

#include <cmath>
#include <string>
#include <utility>

#include "arrays.h"
#include "fields.h"
#include "map.h"
#include "run.h"
#include "signatures.h"

namespace sdm::python {
namespace {

nb::object tuple_of(const Vec3& p) {
  return nb::make_tuple(p[0], p[1], p[2]);
}

/// As tolerance_of(), with None for no limit on one side.
Tolerance group_tolerance_of(nb::handle value, SignMethod sign) {
  const bool is_pair = nb::isinstance<nb::tuple>(value) || nb::isinstance<nb::list>(value);
  if (!is_pair || nb::len(value) != 2 || value[0].is_none() == value[1].is_none())
    return tolerance_of(value, sign);
  return value[0].is_none() ? Tolerance(-kInfinity, real_of(value[1]))
                            : Tolerance(real_of(value[0]), kInfinity);
}

void check(const FaceNames& names) {
  for (const std::uint32_t name : names.of_face)
    if (name != kNone && name >= names.names.size())
      throw Error("of_face has a number of a name that there is not: " + std::to_string(name));
}

void bind_face_names(nb::module_& module) {
  nb::class_<FaceNames>(module, "FaceNames", nb::is_weak_referenceable(),
                        "The names of one kind that the faces of a mesh have.")
      .def(
          "__init__",
          [](FaceNames* self, const std::string& kind, const std::vector<std::string>& names,
             nb::handle of_face) {
            FaceNames made{kind, names, indices(of_face, "of_face")};
            check(made);
            new (self) FaceNames(std::move(made));
          },
          nb::arg("kind"), nb::arg("names"), nb::arg("of_face"),
          nb::sig("def __init__(self, kind: str, names: collections.abc.Sequence[str], of_face: object) -> "
                  "None"),
          "of_face: for each face the number of its name, or 0xFFFFFFFF. Raises Error for others.")
      .def_ro("kind", &FaceNames::kind, "'object', 'group', 'material', 'face', 'color' or any other word.")
      .def_ro("names", &FaceNames::names, "Each name once.")
      .def_prop_ro(
          "of_face",
          [](const FaceNames& self) {
            std::vector<std::uint32_t> copy = self.of_face;
            const std::size_t count = copy.size();
            return array_of<std::uint32_t>(std::move(copy), {count});
          },
          nb::sig("def of_face(self) -> numpy.typing.NDArray[numpy.uint32]"),
          "For each face the number of its name, or 0xFFFFFFFF without one, (m,) uint32.")
      .def("__repr__", [](const FaceNames& self) {
        return nb::str("sdm.FaceNames({!r}, {} names)").format(self.kind, self.names.size());
      });
  module.def(
      "read_face_names",
      [](nb::handle file) {
        const std::filesystem::path path = path_of(file);
        std::vector<FaceNames> names;
        run(nb::none(), [&](const Progress&) { names = read_mesh_file(path).names; });
        return names;
      },
      nb::arg("file").none(), nb::sig("def read_face_names(file: str | os.PathLike[str]) -> list[FaceNames]"),
      R"(Reads the names that a file gives to the faces of its mesh: of objects, groups, materials, CAD faces and colors.

The faces are those that Mesh has of the same file. Raises Error, naming the file and the fault.

>>> sdm.read_face_names('no such file.obj')
Traceback (most recent call last):
    ...
sdm.Error: ...
)");
}

void bind_places(nb::module_& module) {
  nb::class_<Place> place(module, "Place", nb::is_weak_referenceable(),
                          "A region whose distances are all beyond the same limit.");
  bind_fields(place, {"point"})
      .def_prop_ro(
          "point", [](const Place& self) { return tuple_of(self.point); },
          nb::sig("def point(self) -> tuple[float, float, float]"), text_of_field<Place>("point").c_str())
      .def("__repr__", [](const Place& self) {
        return nb::str("sdm.Place(distance={:.6g}, fraction={:.3g})").format(self.distance, self.fraction);
      });
  nb::class_<Places> places(module, "Places", nb::is_weak_referenceable(),
                            "Where a map or a cloud deviates most, as regions.");
  bind_fields(places)
      .def_prop_ro(
          "count", [](const Places& self) { return self.large.count; },
          "The number of places that are not small.")
      .def_prop_ro("small_count", [](const Places& self) { return self.small.count; })
      .def_prop_ro(
          "fraction", [](const Places& self) { return self.large.fraction; },
          "Theirs of the area or the points, without the small ones.")
      .def_prop_ro("small_fraction", [](const Places& self) { return self.small.fraction; })
      .def("__repr__", [](const Places& self) {
        return nb::str("sdm.Places({} places, {} small ones)").format(self.large.count, self.small.count);
      });
}

void bind_verdicts(nb::module_& module) {
  nb::class_<GroupVerdict> group(module, "GroupVerdict", nb::is_weak_referenceable(),
                                 "The verdict on a group of faces.");
  bind_fields(group).def("__repr__", [](const GroupVerdict& self) {
    return nb::str("sdm.GroupVerdict({!r}, {!r})").format(self.group, word_of(self.verdict.verdict));
  });
  nb::class_<GroupVerdicts> groups(module, "GroupVerdicts", nb::is_weak_referenceable(),
                                   "The verdicts on the groups of a table.");
  bind_fields(groups);
  bind_fields_of<PointsWithoutGroup>(groups, [](const GroupVerdicts& self) -> const PointsWithoutGroup& {
    return self.without_group;
  }).def("__repr__", [](const GroupVerdicts& self) {
    return nb::str("sdm.GroupVerdicts({!r}, {} groups)").format(word_of(self.verdict), self.groups.size());
  });
}

GroupVerdicts check_groups(const PyMap& self, nb::handle table, nb::handle names, double uncertainty,
                           nb::handle progress) {
  require_uncertainty(uncertainty);
  if (self.of_itself()) self.require_other_mesh();
  const std::vector<GroupTolerance> rows = table_of(table, self.map.sign.method);
  const auto lock = self.use_surface();
  const auto sites_lock = self.use_sites();
  const Surface& surface = self.on->surface;
  const std::vector<FaceNames> kinds = names_of(names, surface.mesh().triangles.size());
  check_table(rows, kinds);
  GroupVerdicts result;
  run(progress, [&](const Progress& report) {
    result = certify_groups(
        surface, self.to->sites, self.map, self.vertex_distances(report), kinds, rows,
        {.accuracy = self.accuracy(), .guard = self.guard(), .uncertainty = uncertainty, .progress = report});
  });
  return result;
}

Places places(const PyMap& self, nb::handle tolerance, nb::handle names, nb::handle table,
              nb::handle progress) {
  std::optional<Tolerance> accepted;
  if (!tolerance.is_none()) accepted = tolerance_of(tolerance, self.map.sign.method);
  const auto lock = self.use_surface();
  const auto sites_lock = self.use_sites();
  const Surface& surface = self.on->surface;
  std::vector<FaceNames> kinds;
  if (!names.is_none()) kinds = names_of(names, surface.mesh().triangles.size());
  std::vector<GroupTolerance> rows;
  if (!table.is_none()) {
    rows = table_of(table, self.map.sign.method);
    check_table(rows, kinds);
  }
  Places result;
  run(progress, [&](const Progress& report) {
    std::vector<float> at_vertices;
    if (!self.thickness && !self.exclusion) at_vertices = self.vertex_distances(report);
    const double accuracy = self.accuracy(), guard = self.exclusion ? 0 : self.guard();
    result = find_places(surface, self.map, at_vertices,
                         {.tolerance = accepted,
                          .table = rows,
                          .accuracy = std::isfinite(accuracy) ? accuracy + guard : 0,
                          .p99_abs = statistics(surface, self.map).p99_abs,
                          .names = kinds});
  });
  return result;
}

}  // namespace

void check_table(std::span<const GroupTolerance> table, std::span<const FaceNames> names) {
  const std::vector<NamedFaces> found = faces_of_groups(names, table);
  for (std::size_t i = 0; i < found.size(); ++i)
    if (found[i].faces.empty())
      throw Error("no face has the name '" + table[i].group + "' of the table of tolerances; " +
                  names_text(names));
}

std::vector<GroupTolerance> table_of(nb::handle table, SignMethod sign) {
  if (!nb::isinstance<nb::dict>(table)) return read_tolerance_table(path_of(table));
  std::vector<GroupTolerance> rows;
  for (const auto [name, tolerance] : nb::cast<nb::dict>(table)) {
    std::string group;
    if (!nb::try_cast(name, group) || group.empty())
      throw Error("the names of a table of tolerances must be words that are not empty");
    rows.push_back({std::move(group), group_tolerance_of(tolerance, sign)});
  }
  if (rows.empty()) throw Error("the table of tolerances is empty");
  return rows;
}

std::vector<FaceNames> names_of(nb::handle names, std::size_t faces) {
  std::vector<FaceNames> kinds;
  if (nb::isinstance<FaceNames>(names))
    kinds.push_back(nb::cast<FaceNames>(names));
  else if (!nb::try_cast(names, kinds))
    throw Error("names must be FaceNames, or a list of them");
  for (const FaceNames& kind : kinds)
    if (kind.of_face.size() != faces)
      throw Error("names are of " + std::to_string(kind.of_face.size()) + " faces, but the mesh has " +
                  std::to_string(faces));
  return kinds;
}

void bind_groups(nb::module_& module) {
  bind_face_names(module);
  bind_places(module);
  bind_verdicts(module);
}

void bind_map_groups(nb::class_<PyMap>& map) {
  map.def("check_groups", &check_groups, nb::arg("table").none(), nb::arg("names").none(),
          nb::arg("uncertainty"), nb::arg("progress").none())
      .def("places", &places, nb::arg("tolerance").none(), nb::arg("names").none(), nb::arg("table").none(),
           nb::arg("progress").none());
}

}  // namespace sdm::python
