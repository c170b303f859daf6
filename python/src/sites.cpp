// Sites and closest points.
#include <sdm/error.h>

#include <algorithm>

#include "arrays.h"
#include "closest.h"
#include "objects.h"
#include "rays.h"
#include "signatures.h"

namespace sdm::python {
namespace {

// More points are searched on another thread, so that they can be interrupted.
constexpr std::size_t kShort = 4096;

struct QueryOptions {
  double max_distance;
  const char* sign;
  bool gradients;
  const char* engine;
  nb::handle progress;
};

std::unique_ptr<PyClosestPoints> closest(nb::handle self, nb::handle points, const QueryOptions& query) {
  const auto& sites = nb::cast<const PySites&>(self);
  const Points p(points, "points");
  const auto lock = sites.access.use();
  MapOptions options{.sign = enum_of<SignMethod>("sign", query.sign), .max_distance = query.max_distance};
  const bool cpu = query.engine == std::string_view("cpu");
  if (!cpu) options.engine = engine_of(query.engine);

  auto result = std::make_unique<PyClosestPoints>();
  result->owner = nb::borrow(self);
  result->sites = &sites;
  result->version = sites.version;
  result->positions = sites.positions;
  const auto work = [&](const Progress& progress) {
    options.progress = progress;
    result->found = search(sites.sites, p.get(), options);
    if (query.gradients) result->set_gradients(p.get());
  };
  if (p.get().size() <= kShort && cpu && query.progress.is_none()) {
    run_short([&] { work({}); });
  } else {
    run(query.progress, work);
  }
  return result;
}

// What keeps arrays of faces and edges, also over edits.
nb::object version_owner(nb::handle self) {
  const auto& sites = nb::cast<const PySites&>(self);
  return nb::make_tuple(self, detail::capsule_of(new std::shared_ptr<SitesVersion>(sites.version)));
}

constexpr const char* kClosestPoints =
    "The closest points of a mesh to n query points. Arrays are made by the first access.";

void bind_closest_points(nb::module_& module) {
  nb::class_<PyClosestPoints>(module, "ClosestPoints", nb::is_weak_referenceable(), kClosestPoints)
      .def_prop_ro(
          "distance", &PyClosestPoints::distance,
          nb::sig("def distance(self) -> numpy.typing.NDArray[numpy.float64]"),
          "The distances, (n,) float64, in units of the mesh; negative inside the mesh if they are signed. "
          "Infinite where nothing is within max_distance.")
      .def_prop_ro("point", &PyClosestPoints::point,
                   nb::sig("def point(self) -> numpy.typing.NDArray[numpy.float64]"),
                   "The closest points, (n, 3) float64; NaN where there is none.")
      .def_prop_ro("face", &PyClosestPoints::face,
                   nb::sig("def face(self) -> numpy.typing.NDArray[numpy.uint32]"),
                   "A face that contains the closest point, (n,) uint32; NONE where there is none.")
      .def_prop_ro(
          "barycentric", &PyClosestPoints::barycentric,
          nb::sig("def barycentric(self) -> numpy.typing.NDArray[numpy.float64]"),
          "The barycentric coordinates of the closest point in its face, (n, 3) float64: not negative, with "
          "a sum of 1 to rounding. Exactly 0 for corners that the site does not have. NaN where there is "
          "none.")
      .def_prop_ro(
          "site", &PyClosestPoints::site, nb::sig("def site(self) -> numpy.typing.NDArray[numpy.uint32]"),
          "The closest vertex, edge or face, (n,) uint32: an index into the vertices, Sites.edges or the "
          "faces, by site_type; NONE where there is none.")
      .def_prop_ro("site_type", &PyClosestPoints::site_type,
                   nb::sig("def site_type(self) -> numpy.typing.NDArray[numpy.uint8]"),
                   "The kind of each site, (n,) uint8: a SiteType.")
      .def_prop_ro(
          "gradient", &PyClosestPoints::gradient,
          nb::sig("def gradient(self) -> numpy.typing.NDArray[numpy.float64] | None"),
          "The derivative of the distance by the query point, (n, 3) float64, if gradients were requested, "
          "else None: a unit vector. 0 where the distance is 0, where it is not differentiable, and where "
          "there is no closest point. Where several points are equally close, the derivative for the one "
          "that was found.")
      .def("vertex_gradients", &PyClosestPoints::vertex_gradients,
           nb::sig("def vertex_gradients(self) -> tuple[numpy.typing.NDArray[numpy.uint32], "
                   "numpy.typing.NDArray[numpy.float64]]"),
           R"(The derivatives of the distances by the vertices, if gradients were requested.

Returns (vertices, derivatives): (n, 3) uint32 and (n, 3, 3) float64. Distance i depends on the vertices
vertices[i] only; its derivative by the position of vertices[i, k] is derivatives[i, k]. All are 0 where
there is no closest point. Raises Error without gradients.

>>> closest = sdm.closest_points([[0, 0, 0], [3, 0, 0], [0, 3, 0]], [[0, 1, 2]], [[1, 1, 2]],
...                              gradients=True)
>>> vertices, derivatives = closest.vertex_gradients()
>>> closest.gradient[0].tolist(), float(derivatives[0, :, 2].sum().round(12))
([0.0, 0.0, 1.0], -1.0))")
      .def("_pull_back", &PyClosestPoints::pull_back, nb::arg("upstream"), nb::arg("count"),
           nb::sig("def _pull_back(self, upstream: object, count: int) -> "
                   "tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]]"))
      .def("__len__", [](const PyClosestPoints& self) { return self.size(); })
      .def("__repr__", [](const PyClosestPoints& self) {
        return nb::str("sdm.ClosestPoints({} points)").format(self.size());
      });
}

void bind_construction(nb::class_<PySites>& sites) {
  sites.def(
      "__init__",
      [](PySites* self, nb::handle mesh, nb::handle faces) {
        PyMesh value = given_mesh(mesh, faces);
        const std::size_t size = value.mesh.triangles.size();
        InPlace<PySites> made(self);
        run_sized(size, [&] { made.make([&] { return PySites(std::move(value)); }); });
        made.release();
      },
      nb::arg("mesh").none(), nb::arg("faces") = nb::none(),
      nb::sig("def __init__(self, mesh: object, faces: object = None) -> None"));
}

void bind_closest(nb::class_<PySites>& sites) {
  sites.def(
      "closest_points",
      [](nb::handle self, nb::handle points, double max_distance, const char* sign, bool gradients,
         const char* engine, nb::handle progress) {
        return closest(self, points, {max_distance, sign, gradients, engine, progress}).release();
      },
      nb::rv_policy::take_ownership, nb::arg("points").none(), nb::kw_only(),
      nb::arg("max_distance") = kInfinity, nb::arg("sign") = "none", nb::arg("gradients") = false,
      nb::arg("engine") = "cpu", nb::arg("progress") = nb::none(),
      nb::sig("def closest_points(self, points: object, *, max_distance: float = ..., sign: " SDM_SIGN " "
              "= 'none', "
              "gradients: bool = False, engine: " SDM_ENGINE " = 'cpu', progress: "
              "collections.abc.Callable[[str, "
              "float], "
              "bool | None] | None = None) -> ClosestPoints"),
      R"(Returns the closest point of the mesh to each of n points.

points: (n, 3) numbers. float64 in C order is used without a copy, and must not change during the call.
max_distance: > 0, in units of the mesh; points farther away have no closest point.
sign: 'none': unsigned distances; 'exact': negative inside a closed, orientable mesh; 'winding': also for
other meshes, by generalised winding numbers, an estimate of insideness; 'side': negative behind an open mesh, an
estimate; 'automatic': exact where the mesh
allows it, else none.
gradients: whether the result has the derivatives of the distances.
engine: 'cpu' or 'reference'; the site is closest to within 1e-6 of the diagonal of both, or to double
rounding. The distance is that to this site, in double precision. With 'cpu', too, the site is closest to
double rounding, and does not depend on the other points, if these are fewer than 8,192.
progress: called as progress(step, fraction), on this thread; False cancels.

Raises Error for points that are not finite or beyond 1e37, and for a sign that the mesh does not allow;
Cancelled. Cost: one search per point, all cores.

>>> closest = sdm.Sites(box).closest_points([[2, 0.5, 0.25], [2, 2, 2]])
>>> closest.distance
array([1.        , 1.73205081])
>>> closest.site_type == [sdm.SiteType.FACE, sdm.SiteType.VERTEX]
array([ True,  True]))");
}

void bind_signs(nb::class_<PySites>& sites) {
  sites
      .def(
          "signed_distance",
          [](nb::handle self, nb::handle points, const char* sign, double max_distance, nb::handle progress) {
            return closest(self, points, {max_distance, sign, false, "cpu", progress})->distance();
          },
          nb::arg("points").none(), nb::kw_only(), nb::arg("sign") = "exact",
          nb::arg("max_distance") = kInfinity, nb::arg("progress") = nb::none(),
          nb::sig("def signed_distance(self, points: object, *, sign: " SDM_SIGN " = 'exact', "
                  "max_distance: float = ..., "
                  "progress: collections.abc.Callable[[str, float], bool | None] | None = None) -> "
                  "numpy.typing.NDArray[numpy.float64]"),
          R"(Returns the distances of n points, (n,) float64, negative inside the mesh.

As closest_points(), with a sign. Raises Error for an open mesh, unless sign is 'winding'.

>>> sdm.Sites(box).signed_distance([[0.5, 0.5, 0.5], [2, 0.5, 0.5]])
array([-0.5,  1. ]))")
      .def(
          "contains",
          [](nb::handle self, nb::handle points, const char* sign, nb::handle progress) {
            const auto found = closest(self, points, {kInfinity, sign, false, "cpu", progress});
            std::vector<std::uint8_t> inside = std::move(found->found.inside);
            inside.resize(found->size());
            return array_of<bool>(std::move(inside), {found->size()});
          },
          nb::arg("points").none(), nb::kw_only(), nb::arg("sign") = "exact",
          nb::arg("progress") = nb::none(),
          nb::sig("def contains(self, points: object, *, sign: " SDM_SIGN " = 'exact', "
                  "progress: collections.abc.Callable[[str, float], bool | None] | None = None) -> "
                  "numpy.typing.NDArray[numpy.bool_]"),
          R"(Returns whether each of n points lies inside the mesh, (n,) bool.

As the sign of signed_distance(): exact at points farther from the mesh than 1e-6 of the diagonal.

>>> sdm.Sites(box).contains([[0.5, 0.5, 0.5], [2, 0.5, 0.5]])
array([ True, False]))");
}

void bind_refit(nb::class_<PySites>& sites) {
  sites.def(
      "refit",
      [](PySites& self, nb::handle vertices) {
        const Points positions(vertices, "vertices");
        const auto lock = self.access.change();
        self.positions = run_short([&] {
          const std::span<const Vec3> given = positions.get();
          auto kept = std::make_shared<std::vector<Vec3>>(given.begin(), given.end());
          self.sites.refit(*kept);
          return kept;
        });
        ++self.shape;
      },
      nb::arg("vertices").none(), nb::sig("def refit(self, vertices: object) -> None"),
      R"(Moves the vertices and keeps the faces.

vertices: (n, 3) numbers. Earlier results do not change. Raises Error, and changes nothing, for another
number of vertices, for coordinates that are not finite or beyond 1e37, and while another call uses the
object. Cost: linear, a fraction of building the object.

>>> sites = sdm.Sites(box)
>>> sites.refit(sites.vertices + [0, 0, 1])
>>> sites.signed_distance([[0.5, 0.5, 0.75]])
array([0.25]))");
}

void bind_views(nb::class_<PySites>& sites) {
  sites
      .def_prop_ro(
          "vertices", [](const PySites& self) { return positions_view(self.positions); },
          nb::sig("def vertices(self) -> numpy.typing.NDArray[numpy.float64]"),
          "The positions, (n, 3) float64, read-only. The array does not change with a refit or an edit.")
      .def_prop_ro(
          "faces",
          [](nb::handle self) {
            const auto& given = nb::cast<const PySites&>(self);
            const auto lock = given.access.use();
            return faces_view(given.sites.mesh(), version_owner(self));
          },
          nb::sig("def faces(self) -> numpy.typing.NDArray[numpy.uint32]"),
          "The vertices of each face, (m, 3) uint32, read-only.")
      .def_prop_ro(
          "edges",
          [](nb::handle self) {
            const auto& given = nb::cast<const PySites&>(self);
            const auto lock = given.access.use();
            const auto edges = given.sites.edges();
            return view_of<std::uint32_t>(edges, {edges.size(), 2}, version_owner(self));
          },
          nb::sig("def edges(self) -> numpy.typing.NDArray[numpy.uint32]"),
          "The two vertices of each edge, the smaller index first, in lexicographic order, (e, 2) uint32, "
          "read-only.")
      .def_prop_ro(
          "closed",
          [](const PySites& self) {
            const auto lock = self.access.use();
            return self.sites.closed();
          },
          "Whether every edge has exactly two faces.")
      .def_prop_ro(
          "orientable",
          [](const PySites& self) {
            const auto lock = self.access.use();
            return self.sites.orientable();
          },
          "Whether the faces can be oriented consistently.")
      .def("__repr__", [](const PySites& self) {
        const auto lock = self.access.use();
        const Mesh& mesh = self.sites.mesh();
        return nb::str("sdm.Sites({} vertices, {} faces, {})")
            .format(mesh.positions.size(), mesh.triangles.size(), self.sites.closed() ? "closed" : "open");
      });
}

}  // namespace

void bind_sites(nb::module_& module) {
  bind_closest_points(module);
  nb::class_<PySites> sites(
      module, "Sites", nb::is_weak_referenceable(),
      R"(The object that distances are measured to (O2): the faces, edges and vertices of a mesh,
prepared for queries.

mesh, faces: as Mesh. Raises Error for a mesh that cannot be used. Cost: O(m log m) for m faces,
all cores. Several threads may query an object at the same time; refit() raises Error while they
do.

>>> sites = sdm.Sites(box)
>>> sites.closest_points([[2, 0.5, 0.5]]).point
array([[1. , 0.5, 0.5]])
>>> sites.signed_distance([[0.5, 0.5, 0.75]])
array([-0.25]))");
  bind_construction(sites);
  bind_closest(sites);
  bind_signs(sites);
  bind_refit(sites);
  bind_views(sites);
  bind_edit(sites);
  bind_rays(module, sites);
}

}  // namespace sdm::python
