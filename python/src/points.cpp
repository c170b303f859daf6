// Point clouds in files.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <sdm/error.h>
#include <sdm/points.h>

#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "arrays.h"
#include "fields.h"
#include "groups.h"
#include "map.h"
#include "options.h"
#include "signatures.h"
#include "sites_in_use.h"

namespace sdm::python {
namespace {

TextDialect dialect_of(const nb::dict& given) {
  TextDialect dialect;
  set_options(given, dialect);
  validate(dialect);
  return dialect;
}

nb::object read_points(nb::handle file, const nb::kwargs& given) {
  check_keywords("read_points", given);
  const std::filesystem::path path = path_of(file);
  const TextDialect text = dialect_of(given);
  std::vector<Vec3> points, normals;
  run(nb::none(), [&](const Progress&) {
    PointReader reader(path, text);
    constexpr std::size_t kChunk = 1 << 18;
    std::vector<Vec3> next, next_normals;
    while (reader.read(kChunk, next, next_normals)) {
      points.insert(points.end(), next.begin(), next.end());
      normals.insert(normals.end(), next_normals.begin(), next_normals.end());
    }
  });
  const std::size_t count = points.size();
  const bool has_normals = normals.size() == count && count > 0;
  return nb::make_tuple(array_of<double>(std::move(points), {count, 3}),
                        has_normals ? array_of<double>(std::move(normals), {count, 3}) : nb::none());
}

void bind_distances(nb::module_& module) {
  using E = PointExtreme;
  nb::class_<E> extreme(module, "PointExtreme", nb::is_weak_referenceable(),
                        "The distance of a point of a cloud.");
  bind_fields(extreme).def("__repr__", [](const E& self) {
    return nb::str("sdm.PointExtreme({:.6g}, index={})").format(self.distance, self.index);
  });
  using D = PointDistances;
  nb::class_<D> distances(module, "PointDistances", nb::is_weak_referenceable(),
                          "The numbers of the distances of a point cloud to a mesh.");
  bind_fields(distances)
      .def_prop_ro(
          "measured", [](const D& self) { return self.measured.text; },
          "What the distances are to, in words.")
      .def_prop_ro(
          "sign", [](const D& self) { return name_of(self.sign.method); },
          "How inside and outside are distinguished: 'none', 'exact', 'winding' or 'side'.")
      .def_prop_ro(
          "sign_reason", [](const D& self) { return self.sign.reason; }, "Why, in words.")
      .def_prop_ro(
          "islands",
          [](const D& self) -> nb::object {
            if (!self.islands) return nb::none();
            return nb::make_tuple(self.islands->islands, self.islands->points);
          },
          nb::sig("def islands(self) -> tuple[int, int] | None"),
          "The number of islands that were left out and of their points; None if they were not looked for.")
      .def(
          "statistics", [](const D& self) { return self.distance; },
          "Returns statistics of the points with a value, each with the same weight; ``texels`` is their "
          "number.")
      .def("__repr__", [](const D& self) {
        return nb::str("sdm.PointDistances({} points, {:.6g} to {:.6g})")
            .format(self.points, self.distance.min, self.distance.max);
      });
}

void bind_read_points(nb::module_& module) {
  static const std::string signature =
      "def read_points(file: str | os.PathLike[str], *, " + option_signature("read_points") +
      ") -> tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64] | None]";
  static const std::string documentation =
      R"(Reads a point cloud: PLY, PCD 0.7, LAS 1.0 to 1.4 (not LAZ), PTX, PTS, or text with a point a row. The
format is detected from the content.

Of text, where the file leaves them open:
)" + option_documentation("read_points") +
      R"(

Returns (points, normals): (n, 3) float64 each; normals are None if the file has none. NaN marks points without
a measurement. Raises Error, naming the file, the fault and, in text, the line.

>>> sdm.read_points('no such file.ply')
Traceback (most recent call last):
    ...
sdm.Error: ...
)";
  module.def("read_points", &read_points, nb::arg("file").none(), nb::arg("options"),
             nb::sig(signature.c_str()), documentation.c_str());
}

/// Throws if the input is a file, and the one that is to be written.
void require_other(const std::filesystem::path& output, nb::handle input) {
  if (!nb::isinstance<nb::str>(input) && !nb::isinstance<nb::bytes>(input) &&
      !nb::hasattr(input, "__fspath__"))
    return;
  const std::filesystem::path file = path_of(input);
  std::error_code missing;
  if (std::filesystem::equivalent(output, file, missing))
    throw Error("cannot write " + output.string() + ": it is the input " + file.string() +
                "; choose another name");
}

PointDistances measure(nb::handle cloud, nb::handle o2, nb::handle output, nb::handle motion,
                       const char* engine, nb::handle progress, nb::handle tolerance_table, nb::handle names,
                       nb::handle island_points, const nb::kwargs& given) {
  nb::dict all;
  for (const auto& [name, value] : given) all[name] = value;
  all["engine"] = engine;
  check_keywords("measure_points", all);
  const std::filesystem::path from = path_of(cloud), ply = path_of(output);
  for (const nb::handle input : {cloud, o2, tolerance_table}) require_other(ply, input);
  SitesInUse to(o2);
  PointDistancesOptions options{.map = {.engine = engine_of(engine)}};
  set_options(given, options.map);
  if (given.contains("along") && !given["along"].is_none()) {
    options.map.engine = {};
    set_options(given, options.along.emplace());
  }
  options.text = dialect_of(given);
  if (!motion.is_none()) options.placement = transform(motion, "transform");
  set_options(given, options.picture);
  PointDistances result;
  options.guard = to.deviation();
  set_options(given, options);
  run(nb::none(), [&](const Progress&) { (void)to.get(); });
  const SignMethod signs = options.along ? SignMethod::side : choose_sign(to.get(), options.map).method;
  if (options.picture.tolerance) require_sign(*options.picture.tolerance, signs);
  std::vector<GroupTolerance> table;
  std::vector<FaceNames> kinds;
  if (!names.is_none()) kinds = names_of(names, to.get().mesh().triangles.size());
  if (!tolerance_table.is_none()) {
    table = table_of(tolerance_table, signs);
    check_table(table, kinds);
  }
  options.names = kinds;
  options.table = table;
  const auto least = static_cast<std::uint64_t>(integer_of(island_points, "island_points", 0));
  run(progress, [&](const Progress& report) {
    std::optional<CloudIslands> islands;
    if (least > 0) {
      islands.emplace(from, least, CloudIslandsOptions{.text = options.text, .progress = report});
      options.islands = &*islands;
    }
    options.map.progress = report;
    result = measure_points(from, to.get(), ply, options);
  });
  return result;
}

}  // namespace

void bind_points(nb::module_& module) {
  bind_distances(module);
  bind_read_points(module);
  static const std::string signature =
      "def measure_points(cloud: str | os.PathLike[str], o2: object, output: str | os.PathLike[str], *, "
      "transform: object = None, engine: " SDM_ENGINE " = 'cpu', " +
      option_signature("measure_points") +
      "tolerance_table: object = None, names: object = None, island_points: int = 0, " + kProgress +
      "PointDistances";
  static const std::string documentation =
      R"(Computes the distance of each point of a file to a mesh, in parts: the cloud may be larger than the
memory. For points in memory, use Sites.closest_points().

cloud: a file of read_points().
o2: any form of a mesh (see Mesh); Sites are used as they are.
output: a PLY file to write, with the points in their order: x, y, z, the normals if there are any, distance,
face and colours. It must not be one of the inputs.
transform: a 4 × 4 affine matrix that moves the points first, such as Alignment.transform.
)" + option_documentation("measure_points") +
      R"(
engine: as of map(). facing and along='normal' need the normals of the cloud. Along a direction, a cloud without normals
is measured to any face.
The tolerance is also that of ``beyond_tolerance``.
tolerance_table: a file, or a dict of tolerances by name, of the groups of o2 (``groups``): each point is of those of its
closest face; one without a value is of none, and fails. names: FaceNames of the faces of o2, or a list of them, as of read_face_names().
island_points: clusters of fewer points are left out: they have no distance and count for nothing. Finding them reads the
cloud twice more.
progress: called as progress(step, fraction), on this thread; False cancels.

Raises Error, naming the file and the fault; Cancelled. Cost: a search per point, and reading the distances
back three times.)";
  module.def("measure_points", measure, nb::arg("cloud").none(), nb::arg("o2").none(),
             nb::arg("output").none(), nb::kw_only(), nb::arg("transform") = nb::none(),
             nb::arg("engine") = "cpu", nb::arg("progress") = nb::none(),
             nb::arg("tolerance_table") = nb::none(), nb::arg("names") = nb::none(),
             nb::arg("island_points") = 0, nb::arg("options"), nb::sig(signature.c_str()),
             documentation.c_str());
}

}  // namespace sdm::python
