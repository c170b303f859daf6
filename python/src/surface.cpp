// Surfaces, and a surface built beside sites.
#include <sdm/error.h>
#include <sdm/sampling_bound.h>

#include <functional>
#include <memory>
#include <optional>

#include "arrays.h"
#include "objects.h"
#include "options.h"
#include "signatures.h"

namespace sdm::python {
namespace {

struct Layout {
  AtlasOptions options;
  PrecisionOptions fit;
};

Layout layout(const nb::dict& given) {
  Layout result;
  set_options(with_side(given, 1), result.options);
  const std::uint32_t rows = result.options.resolution;
  set_options(with_side(given, 0), result.options);
  if (rows != result.options.resolution) result.options.rows = rows;
  set_options(given, result.fit);
  return result;
}

/// Throws sdm::Error for an option of a layout, which a surface has.
void check_laid_out(const nb::dict& given) {
  for (const OptionInfo& option : call_options("Surface").options)
    if (given.contains(option.name.c_str()) && !given[option.name.c_str()].is_none())
      throw Error("a Surface has its " + option.name + "; give another form of the mesh for another one");
}

std::unique_ptr<PySurface> built(PyMesh mesh, Layout layout, const Progress& progress) {
  layout.options.progress = progress;
  layout.options.resolution = resolution_for(mesh.mesh, layout.fit, layout.options);
  return std::make_unique<PySurface>(std::move(mesh), layout.options);
}

// The copy of `values` that arrays share.
template <class Value, class Values>
const std::shared_ptr<const std::vector<Value>>& copied(std::shared_ptr<const std::vector<Value>>& copy,
                                                        const Values& values) {
  if (!copy) copy = std::make_shared<std::vector<Value>>(values.begin(), values.end());
  return copy;
}
template <class Value>
nb::capsule owner_of(const std::shared_ptr<const std::vector<Value>>& values) {
  return detail::capsule_of(new std::shared_ptr<const std::vector<Value>>(values));
}

// Both objects of sdm.map, built beside each other.
nb::tuple prepare(nb::handle a, nb::handle b, const nb::dict& given, nb::handle motion, nb::handle progress) {
  const bool has_surface = nb::isinstance<PySurface>(a), has_sites = nb::isinstance<PySites>(b);
  if (has_surface) check_laid_out(given);
  if (has_surface && !motion.is_none())
    throw Error("a Surface cannot be transformed; refit() it, or give another form of the mesh");
  const Layout options = layout(given);
  PyMesh on = has_surface ? PyMesh{} : given_mesh(a, nb::none());
  PyMesh to = has_sites ? PyMesh{} : given_mesh(b, nb::none());
  std::optional<Transform> matrix;
  if (!motion.is_none()) matrix = python::transform(motion, "transform");
  std::unique_ptr<PySurface> surface;
  std::unique_ptr<PySites> sites;
  run(progress, [&](const Progress& report) {
    std::vector<std::function<void()>> tasks;
    if (!has_surface) {
      tasks.emplace_back([&] {
        validate(on.mesh);
        if (matrix) move(on, *matrix);
        surface = built(std::move(on), options, report);
      });
    }
    if (!has_sites) tasks.emplace_back([&] { sites = std::make_unique<PySites>(std::move(to)); });
    run_concurrently(tasks);
  });
  const auto object_of = [](auto& owned, nb::handle used) -> nb::object {
    return owned ? nb::cast(owned.release(), nb::rv_policy::take_ownership) : nb::borrow(used);
  };
  return nb::make_tuple(object_of(surface, a), object_of(sites, b));
}

void bind_prepare(nb::module_& module) {
  module.def(
      "prepare", &prepare, nb::arg("a").none(), nb::arg("b").none(), nb::arg("options"),
      nb::arg("transform") = nb::none(), nb::arg("progress") = nb::none(),
      nb::sig("def prepare(a: object, b: object, options: dict[str, object], transform: object = None, "
              "progress: collections.abc.Callable[[str, float], bool | None] | None = None) -> "
              "tuple[Surface, Sites]"));
}

void bind_construction(nb::class_<PySurface>& surface) {
  static const std::string signature = "def __init__(self, mesh: object, faces: object = None, *, " +
                                       option_signature("Surface") + kProgress + "None";
  surface.def(
      "__init__",
      [](PySurface* self, nb::handle mesh, nb::handle faces, nb::handle progress, const nb::kwargs& given) {
        check_keywords("Surface", given);
        const Layout options = layout(given);
        PyMesh value = given_mesh(mesh, faces);
        InPlace<PySurface> made(self);
        run(progress, [&](const Progress& report) {
          AtlasOptions atlas_options = options.options;
          atlas_options.progress = report;
          atlas_options.resolution = resolution_for(value.mesh, options.fit, atlas_options);
          made.make([&] { return PySurface(std::move(value), atlas_options); });
        });
        made.release();
      },
      nb::arg("mesh").none(), nb::arg("faces") = nb::none(), nb::kw_only(), nb::arg("progress") = nb::none(),
      nb::arg("options"), nb::sig(signature.c_str()));
}

void bind_measures(nb::class_<PySurface>& type) {
  type.def(
          "refit",
          [](PySurface& self, nb::handle vertices) {
            const Points positions(vertices, "vertices");
            const auto lock = self.access.change();
            self.positions = run_short([&] {
              const std::span<const Vec3> given = positions.get();
              auto kept = std::make_shared<std::vector<Vec3>>(given.begin(), given.end());
              self.surface.refit(*kept);
              return kept;
            });
            ++self.shape;
          },
          nb::arg("vertices").none(), nb::sig("def refit(self, vertices: object) -> None"),
          R"(Moves the vertices and keeps the faces and the atlas.

vertices: (n, 3) numbers. Maps computed before keep their distances. Raises Error, and changes nothing, for
another number of vertices, for coordinates that are not finite or beyond 1e37, and while another call uses
the object. Cost: linear.)")
      .def(
          "covering_radius",
          [](const PySurface& self) {
            const auto lock = self.access.use();
            return run_sized(self.surface.texel_faces().size(),
                             [&] { return covering_radius(self.surface); });
          },
          R"(Returns an upper bound on the distance from any point of the surface to the nearest texel's
centre, in units of the mesh. Cost: linear in texels and faces, all cores.)")
      .def_prop_ro(
          "resolution", [](const PySurface& self) { return self.surface.resolution(); }, "Texels per row.")
      .def_prop_ro(
          "rows", [](const PySurface& self) { return self.surface.rows(); },
          "Texels per column: as many as per row unless ``resolution`` was two numbers, until edits add "
          "rows.")
      .def_prop_ro(
          "atlas", [](const PySurface& self) { return name_of(self.surface.atlas_kind()); },
          "The kind of the atlas: 'charts', 'triangles' or 'uv'.")
      .def_prop_ro(
          "chart_count", [](const PySurface& self) { return self.surface.chart_count(); },
          "The number of charts.")
      .def_prop_ro(
          "utilisation", [](const PySurface& self) { return self.surface.utilisation(); },
          "The fraction of texels that a face owns.")
      .def_prop_ro(
          "area_fraction_without_texels",
          [](const PySurface& self) { return area_fraction_without_texels(self.surface); },
          "The fraction of the area that lies in faces without a texel: arrays and pictures of maps do not "
          "show it; statistics have one sample of each of these faces.")
      .def_prop_ro(
          "max_stretch", [](const PySurface& self) { return self.surface.max_stretch(); },
          "The largest factor by which a length grows from atlas to surface, for the first shape.");
}

void bind_arrays(nb::class_<PySurface>& type) {
  type.def_prop_ro(
          "vertices", [](const PySurface& self) { return positions_view(self.positions); },
          nb::sig("def vertices(self) -> numpy.typing.NDArray[numpy.float64]"),
          "The positions, (n, 3) float64, read-only. The array does not change with a refit or an edit.")
      .def_prop_ro(
          "faces",
          [](const PySurface& self) {
            const auto lock = self.access.use();
            const auto& faces = copied(self.faces, self.surface.mesh().triangles);
            return view_of<std::uint32_t>(*faces, {faces->size(), 3}, owner_of(faces));
          },
          nb::sig("def faces(self) -> numpy.typing.NDArray[numpy.uint32]"),
          "The vertices of each face, (m, 3) uint32, read-only.")
      .def_prop_ro(
          "uvs",
          [](const PySurface& self) {
            const auto lock = self.access.use();
            const std::size_t count = self.surface.mesh().triangles.size();
            std::vector<std::array<Vec2, 3>> uvs(count);
            const auto charts = self.surface.face_charts();
            constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
            for (std::uint32_t face = 0; face < count; ++face)
              uvs[face] = charts[face] == kNone
                              ? std::array<Vec2, 3>{{{kNan, kNan}, {kNan, kNan}, {kNan, kNan}}}
                              : self.surface.atlas_corners(face);
            return array_of<double>(std::move(uvs), {count, 3, 2});
          },
          nb::sig("def uvs(self) -> numpy.typing.NDArray[numpy.float64]"),
          "The place of each corner of each face in the atlas, (m, 3, 2) float64: u to the right and v "
          "downwards, in texels; "
          "NaN for faces without area. A new array at each access.")
      .def_prop_ro(
          "texel_faces",
          [](const PySurface& self) {
            const auto lock = self.access.use();
            const Surface& surface = self.surface;
            const auto& owners = copied(self.texel_faces, surface.texel_faces());
            return view_of<std::uint32_t>(*owners, {surface.rows(), surface.resolution()}, owner_of(owners));
          },
          nb::sig("def texel_faces(self) -> numpy.typing.NDArray[numpy.uint32]"),
          "The face that owns each texel, or NONE, (H, W) uint32, read-only; row 0 at the top.")
      .def("__repr__", [](const PySurface& self) {
        const Mesh& mesh = self.surface.mesh();
        return nb::str("sdm.Surface({} vertices, {} faces, {} × {} texels)")
            .format(mesh.positions.size(), mesh.triangles.size(), self.surface.resolution(),
                    self.surface.rows());
      });
}

}  // namespace

void bind_surface(nb::module_& module) {
  static const std::string documentation =
      R"(The surface on which distances are measured (O1): a mesh laid out in a texture.

mesh, faces: as Mesh.
)" + option_documentation("Surface") +
      R"(
progress: called as progress(step, fraction), on this thread; False cancels.

Raises Error for a mesh or options that cannot be used; Cancelled.

>>> surface = sdm.Surface(sphere, resolution=256)
>>> surface.texel_faces.shape
(256, 256)
>>> surface.covering_radius() < 0.05
True)";
  nb::class_<PySurface> type(module, "Surface", nb::is_weak_referenceable(), documentation.c_str());
  bind_construction(type);
  bind_measures(type);
  bind_arrays(type);
  bind_edit(type);
  bind_prepare(module);
}

}  // namespace sdm::python
