// Rays against sites.
#include "rays.h"

#include <sdm/error.h>
#include <sdm/rays.h>

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "map.h"
#include "options.h"
#include "values.h"

namespace sdm::python {
namespace {

struct PyRayHits {
  std::vector<RayHit> hits;
  LazyArray t, face, barycentric;
};

}  // namespace

template <>
inline constexpr auto kMembers<RayHit> = std::tuple{&RayHit::face, &RayHit::barycentric, &RayHit::t};
template <>
inline constexpr auto kMembers<PyRayHits> = std::tuple{&PyRayHits::hits};

namespace {

std::vector<Ray> rays_of(nb::handle origins, nb::handle directions, nb::handle t_min, nb::handle t_max) {
  const Points from(origins, "origins"), along(directions, "directions");
  const std::size_t count = from.get().size();
  if (along.get().size() != count)
    throw Error("there are " + std::to_string(count) + " origins, but " + std::to_string(along.get().size()) +
                " directions");
  const Lengths least(t_min, "t_min", count), most(t_max, "t_max", count);
  std::vector<Ray> rays(count);
  run_short([&] {
    for_parts(count, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        rays[i] = {from.get()[i], along.get()[i], least.get()[i], most.get()[i]};
    });
  });
  return rays;
}

constexpr const char* kOfRays =
    "origins: object, directions: object, *, t_min: object = 0.0, t_max: object = ..., progress: "
    "collections.abc.Callable[[str, float], bool | None] | None = None) -> ";

using H = PyRayHits;

void bind_hits(nb::module_& module) {
  const auto hit_column = [](LazyArray H::*array, auto get) {
    return [array, get](H& self) { return (self.*array).get([&] { return column(self.hits, get); }); };
  };
  nb::class_<H>(module, "RayHits", nb::is_weak_referenceable(),
                "The first hits of n rays. Arrays are made by the first access. The points are "
                "``origins + hits.t[:, None] * directions``.")
      .def_prop_ro("t", hit_column(&H::t, [](const RayHit& h) { return h.t; }),
                   nb::sig("def t(self) -> numpy.typing.NDArray[numpy.float64]"),
                   "The parameters of the hits, (n,) float64: lengths, if the directions have length 1. "
                   "Infinite where a ray hits nothing.")
      .def_prop_ro("face", hit_column(&H::face, [](const RayHit& h) { return h.face; }),
                   nb::sig("def face(self) -> numpy.typing.NDArray[numpy.uint32]"),
                   "The faces that are hit, (n,) uint32; NONE where a ray hits nothing.")
      .def_prop_ro("barycentric",
                   hit_column(&H::barycentric,
                              [](const RayHit& h) {
                                constexpr double nan = std::numeric_limits<double>::quiet_NaN();
                                return h.face == kNone ? Vec3{nan, nan, nan} : h.barycentric;
                              }),
                   nb::sig("def barycentric(self) -> numpy.typing.NDArray[numpy.float64]"),
                   "The barycentric coordinates of the hits in their faces, (n, 3) float64; NaN where a ray "
                   "hits nothing.")
      .def("__len__", [](const H& self) { return self.hits.size(); })
      .def("__repr__", [](const H& self) { return nb::str("sdm.RayHits({})").format(self.hits.size()); });
  bind_value<H>();
}

}  // namespace

void bind_rays(nb::module_& module, nb::class_<PySites>& sites) {
  bind_hits(module);
  static const std::string first_hits_signature = std::string("def first_hits(self, ") + kOfRays + "RayHits";
  static const std::string occluded_signature =
      std::string("def occluded(self, ") + kOfRays + "numpy.typing.NDArray[numpy.bool_]";
  sites
      .def(
          "first_hits",
          [](const PySites& self, nb::handle origins, nb::handle directions, nb::handle t_min,
             nb::handle t_max, nb::handle progress) {
            const std::vector<Ray> rays = rays_of(origins, directions, t_min, t_max);
            const auto lock = self.access.use();
            auto result = std::make_unique<H>();
            run(progress, [&](const Progress& report) {
              result->hits = first_hits(self.sites, rays, {.progress = report});
            });
            return result.release();
          },
          nb::rv_policy::take_ownership, nb::arg("origins").none(), nb::arg("directions").none(),
          nb::kw_only(), nb::arg("t_min") = 0.0, nb::arg("t_max") = kInfinity,
          nb::arg("progress") = nb::none(), nb::sig(first_hits_signature.c_str()),
          R"(Returns the first point of the mesh on each of n rays.

A ray has the points origin + t · direction with t_min ≤ t ≤ t_max.
origins, directions: (n, 3) numbers; directions of any length but 0.
t_min, t_max: a number, or (n,) numbers; t_min ≥ 0.
progress: called as progress(step, fraction), on this thread; False cancels.

Whether a ray meets a face is exact: no ray passes between two faces that share an edge. t is rounded. Raises
Error for coordinates or limits that are NaN, a direction of length 0 and a negative t_min; Cancelled. Cost:
one traversal per ray, all cores.

>>> hits = sdm.Sites(box).first_hits([[0.5, 0.25, 3], [5, 5, 5]], [[0, 0, -1], [1, 0, 0]])
>>> hits.t, bool(hits.face[1] == sdm.NONE)
(array([ 2., inf]), True)
>>> np.allclose(hits.barycentric[0] @ sdm.Mesh(box).vertices[sdm.Mesh(box).faces[hits.face[0]]], [0.5, 0.25, 1])
True)")
      .def(
          "occluded",
          [](const PySites& self, nb::handle origins, nb::handle directions, nb::handle t_min,
             nb::handle t_max, nb::handle progress) {
            const std::vector<Ray> rays = rays_of(origins, directions, t_min, t_max);
            const auto lock = self.access.use();
            std::vector<std::uint8_t> flags;
            run(progress,
                [&](const Progress& report) { flags = occluded(self.sites, rays, {.progress = report}); });
            return array_of<bool>(std::move(flags), {rays.size()});
          },
          nb::arg("origins").none(), nb::arg("directions").none(), nb::kw_only(), nb::arg("t_min") = 0.0,
          nb::arg("t_max") = kInfinity, nb::arg("progress") = nb::none(), nb::sig(occluded_signature.c_str()),
          R"(Returns whether each of n rays meets the mesh, (n,) bool; see first_hits(), which costs more.

>>> sdm.Sites(box).occluded([[0.5, 0.25, 3], [0.5, 0.25, 3]], [[0, 0, -1], [0, 0, 1]])
array([ True, False]))");
}

void bind_map_rays(nb::class_<PyMap>& map) {
  map.def(
         "free_distances",
         [](const PyMap& self) {
           self.require_other_mesh();
           const auto lock = self.use_surface();
           const auto sites_lock = self.use_sites();
           auto values = run_sized(
               self.texels(), [&] { return free_distances(self.on->surface, self.to->sites, self.map); });
           return array_of<double>(std::move(values), {self.rows(), self.map.resolution});
         },
         nb::sig("def free_distances(self) -> numpy.typing.NDArray[numpy.float64]"))
      .def(
          "ambient_occlusion",
          [](const PyMap& self, const nb::dict& given, nb::handle progress) {
            AmbientOcclusionOptions options;
            set_options(given, options);
            self.require_other_mesh();
            const auto lock = self.use_surface();
            const auto sites_lock = self.use_sites();
            std::vector<float> values;
            run(progress, [&](const Progress& report) {
              options.progress = report;
              values = ambient_occlusion(self.on->surface, self.to->sites, self.map, options);
            });
            return array_of<float>(std::move(values), {self.rows(), self.map.resolution});
          },
          nb::arg("options"), nb::arg("progress").none(),
          nb::sig("def ambient_occlusion(self, options: dict[str, object], progress: object) -> "
                  "numpy.typing.NDArray[numpy.float32]"));
}

}  // namespace sdm::python
