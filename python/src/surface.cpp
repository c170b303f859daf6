// Surfaces, and a surface built beside sites.
#include <sdm/error.h>
#include <sdm/sampling_bound.h>

#include <cmath>
#include <functional>
#include <memory>
#include <optional>

#include "arrays.h"
#include "objects.h"
#include "signatures.h"

namespace sdm::python {
namespace {

constexpr std::uint32_t kDefaultResolution = 1024;

struct Layout {
  AtlasOptions options;
  std::optional<double> precision;
};

Layout layout(nb::handle resolution, nb::handle precision, const char* atlas, double max_stretch,
              nb::handle gutter) {
  if (!resolution.is_none() && !precision.is_none())
    throw Error("resolution and precision exclude each other; give one of them");
  Layout result;
  result.options.kind = enum_of<AtlasKind>("atlas", atlas);
  const auto unsigned_of = [](nb::handle value, const char* name) {
    return static_cast<std::uint32_t>(integer_of(value, name, 0));
  };
  result.options.resolution = kDefaultResolution;
  if (nb::isinstance<nb::tuple>(resolution) || nb::isinstance<nb::list>(resolution)) {
    if (nb::len(resolution) != 2)
      throw Error("resolution must be an integer, or two: texels per row, and rows");
    result.options.resolution = unsigned_of(nb::object(resolution[0]), "resolution");
    result.options.rows = unsigned_of(nb::object(resolution[1]), "resolution");
  } else if (!resolution.is_none()) {
    result.options.resolution = unsigned_of(resolution, "resolution");
  }
  result.options.max_stretch = max_stretch;
  result.options.gutter = unsigned_of(gutter, "gutter");
  if (!precision.is_none()) result.precision = real_of(precision);
  return result;
}

std::unique_ptr<PySurface> built(PyMesh mesh, Layout layout, const Progress& progress) {
  layout.options.progress = progress;
  if (layout.precision)
    layout.options.resolution = resolution_for(mesh.mesh, *layout.precision, layout.options);
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

#define SDM_LAYOUT_ARGUMENTS                                                                          \
  nb::arg("resolution") = nb::none(), nb::arg("precision") = nb::none(), nb::arg("atlas") = "charts", \
  nb::arg("max_stretch") = AtlasOptions{}.max_stretch, nb::arg("gutter") = AtlasOptions{}.gutter

// Both objects of sdm.map, built beside each other.
nb::tuple prepare(nb::handle a, nb::handle b, nb::handle motion, nb::handle resolution, nb::handle precision,
                  const char* atlas, double max_stretch, nb::handle gutter, nb::handle progress) {
  const bool has_surface = nb::isinstance<PySurface>(a), has_sites = nb::isinstance<PySites>(b);
  if (has_surface && !(resolution.is_none() && precision.is_none()))
    throw Error("a Surface has its resolution; give another form of the mesh for another one");
  if (has_surface && !motion.is_none())
    throw Error("a Surface cannot be transformed; refit() it, or give another form of the mesh");
  const Layout options = layout(resolution, precision, atlas, max_stretch, gutter);
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
  const auto object_of = [](auto& owned, nb::handle given) -> nb::object {
    return owned ? nb::cast(owned.release(), nb::rv_policy::take_ownership) : nb::borrow(given);
  };
  return nb::make_tuple(object_of(surface, a), object_of(sites, b));
}

void bind_prepare(nb::module_& module) {
  module.def(
      "prepare", &prepare, nb::arg("a").none(), nb::arg("b").none(), nb::kw_only(),
      nb::arg("transform") = nb::none(), SDM_LAYOUT_ARGUMENTS, nb::arg("progress") = nb::none(),
      nb::sig(
          "def prepare(a: object, b: object, *, transform: object = None, resolution: int | tuple[int, int] "
          "| "
          "None = None, precision: "
          "float | None = None, atlas: " SDM_ATLAS " = 'charts', max_stretch: float = 1.3, gutter: int = "
          "1, progress: "
          "collections.abc.Callable[[str, float], bool | None] | None = None) -> tuple[Surface, Sites]"));
}

void bind_construction(nb::class_<PySurface>& surface) {
  surface.def(
      "__init__",
      [](PySurface* self, nb::handle mesh, nb::handle faces, nb::handle resolution, nb::handle precision,
         const char* atlas, double max_stretch, nb::handle gutter, nb::handle progress) {
        const Layout options = layout(resolution, precision, atlas, max_stretch, gutter);
        PyMesh value = given_mesh(mesh, faces);
        InPlace<PySurface> made(self);
        run(progress, [&](const Progress& report) {
          AtlasOptions atlas_options = options.options;
          atlas_options.progress = report;
          if (options.precision)
            atlas_options.resolution = resolution_for(value.mesh, *options.precision, atlas_options);
          made.make([&] { return PySurface(std::move(value), atlas_options); });
        });
        made.release();
      },
      nb::arg("mesh").none(), nb::arg("faces") = nb::none(), nb::kw_only(), SDM_LAYOUT_ARGUMENTS,
      nb::arg("progress") = nb::none(),
      nb::sig("def __init__(self, mesh: object, faces: object = None, *, resolution: int | tuple[int, "
              "int] | None = "
              "None, precision: float | None = None, atlas: " SDM_ATLAS " = 'charts', max_stretch: float "
              "= 1.3, "
              "gutter: "
              "int = 1, "
              "progress: collections.abc.Callable[[str, float], bool | None] | None = None) -> None"));
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
  nb::class_<PySurface> type(
      module, "Surface", nb::is_weak_referenceable(),
      R"(The surface on which distances are measured (O1): a mesh laid out in a texture.

mesh, faces: as Mesh.
resolution: texels per side, 16 to 32768; 1024 by default. With atlas='uv' also two integers, the texels
per row and the rows.
precision: instead of the resolution, the largest distance allowed from a point of the surface
to the nearest texel's centre, in units of the mesh.
atlas: 'charts': clusters of faces; 'triangles': single faces, without distortion; 'uv': the
mesh's own texture coordinates.
max_stretch: bounds the growth of lengths from atlas to surface, for charts; in (1, 100]. From
1.1034 on, faces are stretched by up to 4 where noise of a scan would leave too little of the atlas.
gutter: free texels around each chart.
progress: called as progress(step, fraction), on this thread; False cancels.

Raises Error for a mesh or options that cannot be used; Cancelled.

>>> surface = sdm.Surface(sphere, resolution=256)
>>> surface.texel_faces.shape
(256, 256)
>>> surface.covering_radius() < 0.05
True)");
  bind_construction(type);
  bind_measures(type);
  bind_arrays(type);
  bind_edit(type);
  bind_prepare(module);
}

}  // namespace sdm::python
