// Maps: what python/sdm/_distance_map.py presents.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <sdm/error.h>
#include <sdm/io.h>
#include <sdm/sampling_bound.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "arrays.h"
#include "objects.h"

namespace sdm::python {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct PyMap {
  nb::object surface_object, sites_object;
  const PySurface* on = nullptr;
  const PySites* to = nullptr;
  std::uint64_t surface_shape = 0, sites_shape = 0;  ///< when the map was computed
  MapOptions options;
  DistanceMap map;

  [[nodiscard]] std::size_t texels() const { return map.distance.size(); }
  [[nodiscard]] std::size_t rows() const { return map.rows(); }

  /// Locks the surface, and throws if it has another shape than that of the map.
  [[nodiscard]] auto use_surface() const {
    auto lock = on->access.use();
    if (on->shape != surface_shape)
      throw Error("the surface has been refitted since the map was computed; compute the map again");
    return lock;
  }
  [[nodiscard]] auto use_sites() const {
    auto lock = to->access.use();
    if (to->shape != sites_shape)
      throw Error("the sites have been refitted since the map was computed; compute the map again");
    return lock;
  }
  [[nodiscard]] double accuracy() const {
    const EngineInfo& engine = options.engine ? engine_info(*options.engine) : engines().front();
    return engine_accuracy(engine, on->surface.mesh(), to->sites.mesh());
  }
  [[nodiscard]] std::vector<float> vertex_distances(const Progress& progress) const {
    MapOptions at_vertices = options;
    at_vertices.progress = progress;
    return distances_at_vertices(on->surface.mesh(), to->sites, at_vertices);
  }
};

std::unique_ptr<PyMap> compute(nb::handle surface, nb::handle sites, const char* engine, const char* sign,
                               double max_distance, nb::handle progress) {
  auto result = std::make_unique<PyMap>();
  result->surface_object = nb::borrow(surface);
  result->sites_object = nb::borrow(sites);
  result->on = &nb::cast<const PySurface&>(surface);
  result->to = &nb::cast<const PySites&>(sites);
  const auto lock = result->on->access.use();
  const auto sites_lock = result->to->access.use();
  result->surface_shape = result->on->shape;
  result->sites_shape = result->to->shape;
  result->options = {.engine = engine_of(engine), .sign = sign_of(sign), .max_distance = max_distance};
  run(progress, [&](const Progress& report) {
    MapOptions options = result->options;
    options.progress = report;
    compute_map(result->on->surface, result->to->sites, options, result->map);
  });
  return result;
}

nb::object positions(const PyMap& self) {
  const auto lock = self.use_surface();
  auto values = run_short([&] {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    std::vector<Vec3> result(self.texels(), Vec3{nan, nan, nan});
    const std::vector<Vec3> points = self.on->surface.sample_points();
    const auto texels = self.on->surface.sample_texels();
    for (std::size_t i = 0; i < points.size(); ++i) result[texels[i]] = points[i];
    return result;
  });
  return array_of<double>(std::move(values), {self.rows(), self.map.resolution, 3});
}

// The unit normals of all faces.
std::vector<Vec3f> face_normals(const Mesh& mesh) {
  std::vector<Vec3f> normals(mesh.triangles.size());
  for (std::size_t f = 0; f < normals.size(); ++f) {
    const Triangle& corners = mesh.triangles[f];
    const auto edge = [&](int to) {
      const Vec3 &p = mesh.positions[corners[0]], &q = mesh.positions[corners[to]];
      return Vec3{q[0] - p[0], q[1] - p[1], q[2] - p[2]};
    };
    const Vec3 u = edge(1), v = edge(2);
    const Vec3 n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    const double length = std::hypot(n[0], n[1], n[2]);
    for (int k = 0; k < 3; ++k) normals[f][k] = static_cast<float>(n[k] / length);
  }
  return normals;
}

nb::object normals(const PyMap& self) {
  const auto lock = self.use_surface();
  auto values = run_short([&] {
    const std::vector<Vec3f> of_faces = face_normals(self.on->surface.mesh());
    std::vector<Vec3f> result(self.texels(), Vec3f{kNan, kNan, kNan});
    const auto owners = self.on->surface.texel_faces();
    for (std::size_t t = 0; t < result.size(); ++t)
      if (owners[t] != kNone) result[t] = of_faces[owners[t]];
    return result;
  });
  return array_of<float>(std::move(values), {self.rows(), self.map.resolution, 3});
}

// Whether distances change by no more than the point moves also where they change their sign.
bool sign_is_continuous(const PyMap& self) {
  return self.map.sign.method == SignMethod::none || (self.to->sites.closed() && self.to->sites.orientable());
}

// (lower, upper, covering radius, accuracy): lower ≤ d(p) ≤ upper for all points p of the surface.
nb::object bounds(const PyMap& self) {
  const auto lock = self.use_surface();
  const auto sites_lock = self.use_sites();
  double lower = std::numeric_limits<double>::infinity(), upper = -lower, radius = 0;
  const double accuracy = self.accuracy();
  run_short([&] {
    const SamplingBound bound(self.on->surface);
    const auto texels = self.on->surface.sample_texels();
    const auto radii = bound.sample_radii();
    radius = bound.value();
    const bool keep_sign = sign_is_continuous(self);
    for (std::size_t i = 0; i < texels.size(); ++i) {
      const double d = self.map.distance[texels[i]];
      if (!std::isfinite(d)) continue;
      const double reach = double{radii[i]} + accuracy;
      lower = std::min(lower, d - reach);
      upper = std::max(upper, (keep_sign ? d : std::abs(d)) + reach);
    }
    if (self.map.beyond_max_distance > 0) upper = std::numeric_limits<double>::infinity();
    if (self.map.sign.method == SignMethod::none) lower = std::max(lower, 0.0);
    if (!keep_sign) lower = -upper;
  });
  return nb::make_tuple(lower, upper, radius, accuracy);
}

Colormap colormap_of(const std::string& name) {
  constexpr std::array<std::pair<const char*, Colormap>, 4> kNames{{{"automatic", Colormap::automatic},
                                                                    {"viridis", Colormap::viridis},
                                                                    {"diverging", Colormap::diverging},
                                                                    {"paper2006", Colormap::paper2006}}};
  for (const auto& [known, value] : kNames)
    if (name == known) return value;
  throw Error("colormap must be one of automatic, viridis, diverging, paper2006, not '" + name + "'");
}

// The accepted distances: a number, or the least and the most.
Tolerance tolerance_of(nb::handle value, const DistanceMap& map) {
  Tolerance tolerance;
  if (nb::isinstance<nb::tuple>(value) || nb::isinstance<nb::list>(value)) {
    if (nb::len(value) != 2) throw Error("tolerance must be a number, or the least and the most distance");
    tolerance = {nb::cast<double>(nb::float_(value[0])), nb::cast<double>(nb::float_(value[1]))};
  } else {
    tolerance = nb::cast<double>(nb::float_(nb::borrow(value)));
  }
  if (!(tolerance.lo <= tolerance.hi) || !std::isfinite(tolerance.hi - tolerance.lo))
    throw Error("tolerance must be a finite number that is not negative, or two, the smaller one first");
  if (tolerance.needs_sign() && map.sign.method == SignMethod::none)
    throw Error("a tolerance that differs by the sign needs signed distances, but the map is unsigned");
  return tolerance;
}

// The mesh of the surface as if it had been read from a file.
FileVertices file_vertices(const Mesh& mesh) {
  FileVertices result{.positions = mesh.positions, .mesh_vertex = {}, .corners = {}, .ends = {}};
  result.mesh_vertex.resize(mesh.positions.size());
  std::iota(result.mesh_vertex.begin(), result.mesh_vertex.end(), 0u);
  for (const Triangle& triangle : mesh.triangles) {
    result.corners.insert(result.corners.end(), triangle.begin(), triangle.end());
    result.ends.push_back(static_cast<std::uint32_t>(result.corners.size()));
  }
  return result;
}

void write(const PyMap& self, const std::string& format, const std::string& file, const std::string& colormap,
           std::optional<std::pair<double, double>> range, nb::handle tolerance, const std::string& units,
           std::uint32_t largest, nb::handle progress) {
  const auto lock = self.use_surface();
  const auto sites_lock = self.use_sites();
  PictureOptions picture{.colormap = colormap_of(colormap), .units = units, .largest = largest};
  if (largest < 16) throw Error("size must be at least 16 pixels");
  if (!tolerance.is_none()) picture.tolerance = tolerance_of(tolerance, self.map);
  if (range) {
    if (!(range->first < range->second) || !std::isfinite(range->second - range->first))
      throw Error("range must be two finite numbers, the smaller one first");
    picture.range = {range->first, range->second};
  }
  const double accuracy = self.accuracy();
  if (std::isfinite(accuracy)) picture.accuracy = accuracy;
  const std::filesystem::path path(file);
  const Surface& surface = self.on->surface;
  using WriteVertices = void (*)(const std::filesystem::path&, const FileVertices&, std::span<const float>);
  const std::map<std::string, WriteVertices> of_vertices{{"ply", write_vertices_ply},
                                                         {"csv", write_vertices_csv},
                                                         {"npy", write_vertices_npy},
                                                         {"vtp", write_vertices_vtp}};
  run(progress, [&](const Progress& report) {
    if (const auto found = of_vertices.find(format); found != of_vertices.end()) {
      found->second(path, file_vertices(surface.mesh()), self.vertex_distances(report));
    } else if (format == "exr") {
      std::vector<std::uint8_t> boundary;
      if (!self.to->sites.closed()) boundary = boundary_mask(self.to->sites, self.map);
      write_exr(path, surface, self.map, boundary);
    } else if (format == "glb") {
      write_glb(path, surface, self.map, self.vertex_distances(report), picture);
    } else {
      write_distance_png(path, surface, self.map, picture);
    }
  });
}

void bind_statistics(nb::module_& module) {
  using S = DistanceStatistics;
  nb::class_<S>(
      module, "DistanceStatistics",
      "Statistics of the texels of a map that have a value, each weighted by its area on the surface. "
      "Distances are NaN if there are none. Estimates for the surface: DistanceMap.bounds holds everywhere.")
      .def_ro("texels", &S::texels, "The number of texels that have a value.")
      .def_ro("negative_texels", &S::negative_texels, "The number of those inside.")
      .def_ro("negative_area_fraction", &S::negative_area_fraction, "Their fraction of the area, in [0, 1].")
      .def_ro("min", &S::min)
      .def_ro("max", &S::max)
      .def_ro("mean", &S::mean)
      .def_ro("rms", &S::rms)
      .def_ro("stddev", &S::stddev, "About the mean.")
      .def_ro("p01", &S::p01, "A percentile, weighted by area.")
      .def_ro("p05", &S::p05)
      .def_ro("p50", &S::p50, "The median, weighted by area.")
      .def_ro("p95", &S::p95)
      .def_ro("p99", &S::p99)
      .def_ro("mean_abs", &S::mean_abs, "Of the absolute distances.")
      .def_ro("max_abs", &S::max_abs)
      .def_ro("p50_abs", &S::p50_abs)
      .def_ro("p95_abs", &S::p95_abs)
      .def_ro("p99_abs", &S::p99_abs)
      .def("__repr__", [](const S& s) {
        return nb::str("sdm.DistanceStatistics(min={:.6g}, max={:.6g}, mean={:.6g}, rms={:.6g}, texels={})")
            .format(s.min, s.max, s.mean, s.rms, s.texels);
      });
}

}  // namespace

void bind_map(nb::module_& module) {
  bind_statistics(module);
  nb::class_<PyMap>(module, "Map", "The compiled part of DistanceMap.")
      .def_prop_ro(
          "surface", [](const PyMap& self) { return self.surface_object; },
          nb::sig("def surface(self) -> Surface"))
      .def_prop_ro(
          "sites", [](const PyMap& self) { return self.sites_object; }, nb::sig("def sites(self) -> Sites"))
      .def_prop_ro(
          "distance",
          [](nb::handle self) {
            const DistanceMap& map = nb::cast<const PyMap&>(self).map;
            return texels_of<float>(map.distance, map, self);
          },
          nb::sig("def distance(self) -> numpy.ndarray"))
      .def_prop_ro(
          "vector",
          [](nb::handle self) {
            const DistanceMap& map = nb::cast<const PyMap&>(self).map;
            return texels_of<float>(map.vector, map, self);
          },
          nb::sig("def vector(self) -> numpy.ndarray"))
      .def_prop_ro(
          "site",
          [](nb::handle self) {
            const DistanceMap& map = nb::cast<const PyMap&>(self).map;
            return texels_of<std::uint32_t>(map.site, map, self);
          },
          nb::sig("def site(self) -> numpy.ndarray"))
      .def_prop_ro(
          "site_type",
          [](nb::handle self) {
            const DistanceMap& map = nb::cast<const PyMap&>(self).map;
            return texels_of<std::uint8_t>(map.site_type, map, self);
          },
          nb::sig("def site_type(self) -> numpy.ndarray"))
      .def("position", &positions, nb::sig("def position(self) -> numpy.ndarray"))
      .def("normal", &normals, nb::sig("def normal(self) -> numpy.ndarray"))
      .def_prop_ro("beyond_max_distance", [](const PyMap& self) { return self.map.beyond_max_distance; })
      .def_prop_ro("sign", [](const PyMap& self) { return name_of(self.map.sign.method); })
      .def_prop_ro("sign_reason", [](const PyMap& self) { return self.map.sign.reason; })
      .def("statistics",
           [](const PyMap& self) {
             const auto lock = self.use_surface();
             return run_short([&] { return statistics(self.on->surface, self.map); });
           })
      .def("bounds", &bounds, nb::sig("def bounds(self) -> tuple[float, float, float, float]"))
      .def(
          "at_vertices",
          [](const PyMap& self, nb::handle progress) {
            const auto lock = self.use_surface();
            const auto sites_lock = self.use_sites();
            std::vector<float> distances;
            run(progress, [&](const Progress& report) { distances = self.vertex_distances(report); });
            const std::size_t count = distances.size();
            return array_of<float>(std::move(distances), {count});
          },
          nb::arg("progress") = nb::none(),
          nb::sig("def at_vertices(self, progress: object = None) -> numpy.ndarray"))
      .def("write", &write, nb::arg("format"), nb::arg("file").none(), nb::kw_only(),
           nb::arg("colormap") = "automatic", nb::arg("range") = nb::none(),
           nb::arg("tolerance") = nb::none(), nb::arg("units") = "", nb::arg("size") = 2048,
           nb::arg("progress") = nb::none(),
           nb::sig("def write(self, format: str, file: str, *, colormap: str = 'automatic', range: "
                   "tuple[float, float] | "
                   "None = None, tolerance: float | tuple[float, float] | None = None, units: str = '', "
                   "size: int = 2048, "
                   "progress: object = "
                   "None) -> None"));

  module.def(
      "compute_map",
      [](nb::handle surface, nb::handle sites, const char* engine, const char* sign, double max_distance,
         nb::handle progress) {
        return compute(surface, sites, engine, sign, max_distance, progress).release();
      },
      nb::rv_policy::take_ownership, nb::arg("surface").none(), nb::arg("sites").none(), nb::kw_only(),
      nb::arg("engine") = "cpu", nb::arg("sign") = "automatic",
      nb::arg("max_distance") = std::numeric_limits<double>::infinity(), nb::arg("progress") = nb::none(),
      nb::sig(
          "def compute_map(surface: Surface, sites: Sites, *, engine: str = 'cpu', sign: str = 'automatic', "
          "max_distance: float = ..., progress: collections.abc.Callable[[str, float], bool | None] | None = "
          "None) "
          "-> Map"));
}

}  // namespace sdm::python
