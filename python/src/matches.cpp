// Matches of texels, and the geometry of O2 there: what python/sdm/_matches.py presents.
#include <sdm/bake.h>
#include <sdm/match.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "arrays.h"
#include "map.h"
#include "options.h"
#include "run.h"
#include "stored.h"

namespace sdm::python {
namespace {

struct PyMatches {
  nb::object surface_object, sites_object;
  const PySurface* on = nullptr;
  const PySites* to = nullptr;
  std::uint64_t surface_shape = 0, sites_shape = 0;  ///< when they were found
  TexelMatches matches;

  PyMatches(nb::object surface, nb::object sites)
      : surface_object(std::move(surface)),
        sites_object(std::move(sites)),
        on(&nb::cast<const PySurface&>(surface_object)),
        to(&nb::cast<const PySites&>(sites_object)),
        surface_shape(on->shape),
        sites_shape(to->shape) {}

  /// Locks both, and throws if one has another shape than the matches.
  [[nodiscard]] auto use() const {
    auto locks = std::pair(on->access.use(), to->access.use());
    if (on->shape != surface_shape || to->shape != sites_shape)
      throw Error(
          "the surface or the sites have been refitted or edited since the matches were found; match again");
    return locks;
  }
  /// Values of each texel, filled if asked for. `compute` is called on a thread of its own, with the locks.
  template <class Compute>
  [[nodiscard]] nb::object values(std::size_t components, bool fill, nb::handle progress,
                                  const Compute& compute) const {
    const auto locks = use();
    std::vector<float> found;
    run(progress, [&](const Progress& report) {
      found = compute(report);
      if (fill) fill_texels(on->surface, components, found);
    });
    if (components == 1) return array_of<float>(std::move(found), {matches.rows(), matches.resolution});
    return array_of<float>(std::move(found), {matches.rows(), matches.resolution, components});
  }
};

using CornerArray = nb::ndarray<const float, nb::shape<-1, 3, 3>, nb::c_contig, nb::device::cpu>;

/// `normals`: the angle of creases, or vectors at the corners of the faces, NaN where there are none.
MeshAttribute corner_normals(nb::handle normals, const Mesh& mesh) {
  if (nb::isinstance<nb::float_>(normals)) return smooth_normals(mesh, nb::cast<double>(normals));
  const auto given = nb::cast<CornerArray>(normals);
  MeshAttribute result{.name = "normal", .components = 3, .values = {}, .rows = nullptr};
  result.values.assign(given.data(), given.data() + given.size());
  if (std::ranges::any_of(result.values, [](float x) { return std::isinf(x); }))
    throw Error("normals must be finite, or NaN where there are none");
  std::vector<Triangle> rows(given.shape(0));
  for (std::uint32_t f = 0; f < rows.size(); ++f) rows[f] = {3 * f, 3 * f + 1, 3 * f + 2};
  result.rows = std::make_shared<const std::vector<Triangle>>(std::move(rows));
  return result;
}

PyMatches* found_matches(nb::handle surface, nb::handle sites, const nb::dict& given, nb::handle normals,
                         const char* engine, nb::handle progress) {
  auto result = std::make_unique<PyMatches>(nb::borrow(surface), nb::borrow(sites));
  const auto locks = result->use();
  const MeshAttribute of_corners = corner_normals(normals, result->on->surface.mesh());
  MatchOptions options{.normals = &of_corners, .engine = engine_of(engine)};
  set_options(given, options);
  run(progress, [&](const Progress& report) {
    options.progress = report;
    result->matches = match_texels(result->on->surface, result->to->sites, options);
  });
  return result.release();
}

void bind_match_arrays(nb::class_<PyMatches>& type) {
  const auto shape_of = [](const PyMatches& self) {
    return std::array<std::size_t, 2>{self.matches.rows(), self.matches.resolution};
  };
  type.def_prop_ro(
          "surface", [](const PyMatches& self) { return self.surface_object; },
          nb::sig("def surface(self) -> Surface"))
      .def_prop_ro(
          "sites", [](const PyMatches& self) { return self.sites_object; },
          nb::sig("def sites(self) -> Sites"))
      .def_prop_ro(
          "kind",
          [shape_of](nb::handle self) {
            const auto& matches = nb::cast<const PyMatches&>(self);
            const auto [rows, columns] = shape_of(matches);
            return view_of<std::uint8_t>(matches.matches.kind, {rows, columns}, self);
          },
          nb::sig("def kind(self) -> numpy.typing.NDArray[numpy.uint8]"))
      .def_prop_ro(
          "face",
          [shape_of](nb::handle self) {
            const auto& matches = nb::cast<const PyMatches&>(self);
            const auto [rows, columns] = shape_of(matches);
            return view_of<std::uint32_t>(matches.matches.face, {rows, columns}, self);
          },
          nb::sig("def face(self) -> numpy.typing.NDArray[numpy.uint32]"))
      .def_prop_ro(
          "uv",
          [shape_of](nb::handle self) {
            const auto& matches = nb::cast<const PyMatches&>(self);
            const auto [rows, columns] = shape_of(matches);
            return view_of<float>(matches.matches.barycentric, {rows, columns, 2}, self);
          },
          nb::sig("def uv(self) -> numpy.typing.NDArray[numpy.float32]"));
}

void bind_matched_normals(nb::class_<PyMatches>& type) {
  type.def(
          "normals",
          [](const PyMatches& self, nb::handle of, bool fill, nb::handle progress) {
            const MeshAttribute normals = corner_normals(of, self.to->sites.mesh());
            return self.values(3, fill, progress, [&](const Progress& report) {
              return matched_normals(self.on->surface, self.to->sites, self.matches, normals, report);
            });
          },
          nb::arg("of"), nb::arg("fill"), nb::arg("progress").none(),
          nb::sig("def normals(self, of: object, fill: bool, progress: object) -> "
                  "numpy.typing.NDArray[numpy.float32]"))
      .def(
          "tangent_normals",
          [](const PyMatches& self, nb::handle of, nb::handle normals, bool fill, nb::handle progress) {
            const MeshAttribute wanted = corner_normals(of, self.to->sites.mesh()),
                                own = corner_normals(normals, self.on->surface.mesh());
            return self.values(3, fill, progress, [&](const Progress& report) {
              const Surface& surface = self.on->surface;
              return tangent_space_normals(
                  surface, own, tangents(surface, own),
                  matched_normals(surface, self.to->sites, self.matches, wanted, report), report);
            });
          },
          nb::arg("of"), nb::arg("normals"), nb::arg("fill"), nb::arg("progress").none(),
          nb::sig("def tangent_normals(self, of: object, normals: object, fill: bool, progress: object) -> "
                  "numpy.typing.NDArray[numpy.float32]"));
}

void bind_matched_geometry(nb::class_<PyMatches>& type) {
  type.def(
          "displacements",
          [](const PyMatches& self, nb::handle normals, bool fill, nb::handle progress) {
            const MeshAttribute own = corner_normals(normals, self.on->surface.mesh());
            return self.values(1, fill, progress, [&](const Progress& report) {
              return matched_displacements(self.on->surface, self.to->sites, self.matches, own, report);
            });
          },
          nb::arg("normals"), nb::arg("fill"), nb::arg("progress").none(),
          nb::sig("def displacements(self, normals: object, fill: bool, progress: object) -> "
                  "numpy.typing.NDArray[numpy.float32]"))
      .def(
          "positions",
          [](const PyMatches& self, bool fill, nb::handle progress) {
            return self.values(3, fill, progress, [&](const Progress& report) {
              return matched_positions(self.on->surface, self.to->sites, self.matches, report);
            });
          },
          nb::arg("fill"), nb::arg("progress").none(),
          nb::sig("def positions(self, fill: bool, progress: object) -> "
                  "numpy.typing.NDArray[numpy.float32]"))
      .def(
          "ambient_occlusion",
          [](const PyMatches& self, const nb::dict& given, bool fill, nb::handle progress) {
            AmbientOcclusionOptions options;
            set_options(given, options);
            return self.values(1, fill, progress, [&](const Progress& report) {
              options.progress = report;
              return matched_occlusion(self.on->surface, self.to->sites, self.matches, options);
            });
          },
          nb::arg("options"), nb::arg("fill"), nb::arg("progress").none(),
          nb::sig("def ambient_occlusion(self, options: dict[str, object], fill: bool, progress: object) -> "
                  "numpy.typing.NDArray[numpy.float32]"))
      .def(
          "thickness",
          [](const PyMatches& self, const nb::dict& given, bool fill, nb::handle progress) {
            ThicknessOptions options;
            set_options(given, options);
            return self.values(1, fill, progress, [&](const Progress& report) {
              options.progress = report;
              return matched_thickness(self.on->surface, self.to->sites, self.matches, options.method,
                                       options);
            });
          },
          nb::arg("options"), nb::arg("fill"), nb::arg("progress").none(),
          nb::sig("def thickness(self, options: dict[str, object], fill: bool, progress: object) -> "
                  "numpy.typing.NDArray[numpy.float32]"));
}

void bind_match_state() {
  bind_state<PyMatches>(
      5,
      [](const PyMatches& self) {
        const auto locks = self.use();
        return nb::make_tuple(self.surface_object, self.sites_object, packed(self.matches.kind),
                              packed(self.matches.face), packed(self.matches.barycentric));
      },
      [](PyMatches* self, const nb::tuple& from) {
        PyMatches made(from[0], from[1]);
        made.matches = {.resolution = made.on->surface.resolution(),
                        .kind = unpacked<MatchKind>(from[2]),
                        .face = unpacked<std::uint32_t>(from[3]),
                        .barycentric = unpacked<std::array<float, 2>>(from[4])};
        for (const MatchKind kind : made.matches.kind)
          if (kind > MatchKind::facing_away) throw Error(kDamaged);
        try {
          require_matches(made.on->surface, made.to->sites, made.matches);
        } catch (const Error&) {
          throw Error(kDamaged);
        }
        new (self) PyMatches(std::move(made));
      });
}

}  // namespace

void bind_matches(nb::module_& module) {
  nb::class_<PyMatches> type(module, "TexelMatches", "The compiled part of Matches.");
  bind_match_arrays(type);
  bind_matched_normals(type);
  bind_matched_geometry(type);
  type.def(
      "transfer",
      [](const PyMatches& self, const TransferRows& rows, const char* domain, bool fill,
         nb::handle progress) {
        const auto locks = self.use();
        std::vector<float> values;
        run(progress, [&](const Progress& report) {
          values = transfer(self.on->surface, self.to->sites, self.matches, attribute_of(rows, domain),
                            {.fill = fill, .progress = report});
        });
        return array_of<float>(std::move(values),
                               {self.matches.rows(), self.matches.resolution, rows.shape(1)});
      },
      nb::arg("values"), nb::arg("domain"), nb::arg("fill"), nb::arg("progress").none(),
      nb::sig("def transfer(self, values: numpy.typing.NDArray[numpy.float32], domain: str, fill: bool, "
              "progress: object) -> numpy.typing.NDArray[numpy.float32]"));
  bind_match_state();
  module.def(
      "match_texels", &found_matches, nb::rv_policy::take_ownership, nb::arg("surface"), nb::arg("sites"),
      nb::arg("options"), nb::kw_only(), nb::arg("normals"), nb::arg("engine"), nb::arg("progress").none(),
      nb::sig("def match_texels(surface: Surface, sites: Sites, options: dict[str, object], *, normals: "
              "object, engine: str, progress: object) -> TexelMatches"));
  module.def(
      "smooth_normals",
      [](nb::handle mesh, double crease) {
        const Mesh value = mesh_of(mesh, nb::none());
        validate(value);
        return corner_values(
            run_sized(value.triangles.size(), [&] { return smooth_normals(value, crease); }));
      },
      nb::arg("mesh").none(), nb::arg("crease") = 180.0,
      nb::sig("def smooth_normals(mesh: object, crease: float = 180.0) -> "
              "numpy.typing.NDArray[numpy.float32]"),
      R"(Returns normals of length 1 for the corners of the faces of a mesh, (faces, 3, 3) float32.

mesh: in any form (see Mesh). At each vertex, a normal is the mean of those of the faces there, weighted by their
angles. crease: faces that differ by more degrees than this from the first one of a vertex do not share its normal:
180: all do; 0: the normals of the faces. Faces without area take those of others, or (0, 0, 1). Raises Error for a
mesh that cannot be used, and a negative angle. Cost: linear.

>>> sdm.smooth_normals(box, 30)[0, 0].tolist() in ([[s * (a == k) for a in range(3)] for k in range(3) for s in (1, -1)])
True)");
  module.def("has_tangents", &has_tangents, nb::sig("def has_tangents() -> bool"),
             R"(Returns whether this build has tangents(), which need the source of MikkTSpace.

>>> sdm.has_tangents() in (True, False)
True)");
  module.def(
      "corner_tangents",
      [](const PySurface& self, nb::handle normals) {
        const auto lock = self.access.use();
        const MeshAttribute own = corner_normals(normals, self.surface.mesh());
        return corner_values(
            run_sized(self.surface.mesh().triangles.size(), [&] { return tangents(self.surface, own); }));
      },
      nb::arg("surface"), nb::arg("normals"),
      nb::sig("def corner_tangents(surface: Surface, normals: object) -> "
              "numpy.typing.NDArray[numpy.float32]"));
}

}  // namespace sdm::python
