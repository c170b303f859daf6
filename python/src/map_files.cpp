// The files of a map, and the numbers of its page.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <sdm/io.h>
#include <sdm/sampling_bound.h>
#include <sdm/version.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "map.h"

namespace sdm::python {
namespace {

constexpr std::array<std::pair<const char*, Colormap>, 4> kColormaps{{{"automatic", Colormap::automatic},
                                                                      {"viridis", Colormap::viridis},
                                                                      {"diverging", Colormap::diverging},
                                                                      {"paper2006", Colormap::paper2006}}};

// The options of colours, as Python has them.
struct Colours {
  std::string colormap;
  std::optional<std::pair<double, double>> range;
  nb::handle tolerance;
  std::string units;
};

PictureOptions picture_of(const PyMap& self, const Colours& colours, std::uint32_t largest = 2048) {
  if (largest < 16) throw Error("size must be at least 16 pixels");
  PictureOptions picture{
      .colormap = colormap_of(colours.colormap), .units = colours.units, .largest = largest};
  if (!colours.tolerance.is_none()) picture.tolerance = tolerance_of(colours.tolerance, self.map.sign.method);
  picture.range = range_of(colours.range);
  const double accuracy = self.accuracy();
  if (std::isfinite(accuracy)) picture.accuracy = accuracy;
  return picture;
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

void write(const PyMap& self, const std::string& format, nb::handle file, const std::string& colormap,
           std::optional<std::pair<double, double>> range, nb::handle tolerance, const std::string& units,
           std::uint32_t largest, nb::handle progress) {
  const auto lock = self.use_surface();
  const auto sites_lock = self.use_sites();
  const PictureOptions picture = picture_of(self, {colormap, range, tolerance, units}, largest);
  const std::filesystem::path path = path_of(file);
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
      if (!self.exclusion && !self.to->sites.closed()) boundary = boundary_mask(self.to->sites, self.map);
      write_exr(path, surface, self.map, boundary);
    } else if (format == "glb") {
      write_glb(path, surface, self.map, self.vertex_distances(report), picture);
    } else {
      write_distance_png(path, surface, self.map, picture);
    }
  });
}

// NaN and infinity, which JSON does not have, become None.
nb::object number(double value) {
  return std::isfinite(value) ? nb::object(nb::float_(value)) : nb::none();
}
nb::object numbers(const Vec3& point) {
  nb::list list;
  for (const double x : point) list.append(number(x));
  return list;
}

nb::dict mesh_numbers(const MeshInfo& info, const char* name) {
  nb::dict json;
  json["file"] = name;
  json["transform"] = "";
  json["vertices"] = info.vertices;
  json["triangles"] = info.triangles;
  json["closed"] = info.closed;
  json["degenerate_faces"] = info.degenerate_faces;
  json["duplicate_faces"] = info.duplicate_faces;
  return json;
}

nb::dict atlas_numbers(const Surface& surface) {
  nb::dict json;
  json["kind"] = name_of(surface.atlas_kind());
  json["resolution"] = surface.resolution();
  json["rows"] = surface.rows();
  json["charts"] = surface.chart_count();
  json["texels"] = surface.sample_texels().size();
  json["utilisation"] = surface.utilisation();
  json["max_stretch"] = surface.max_stretch();
  json["gutter"] = surface.gutter();
  json["overlapping_texels"] = surface.overlapping_texels();
  return json;
}

nb::dict statistics_numbers(const DistanceStatistics& d) {
  nb::dict json;
  json["kind"] = "estimate";
  const std::pair<const char*, double> values[] = {
      {"min", d.min},           {"max", d.max},
      {"mean", d.mean},         {"rms", d.rms},
      {"stddev", d.stddev},     {"p01", d.p01},
      {"p05", d.p05},           {"p50", d.p50},
      {"p95", d.p95},           {"p99", d.p99},
      {"mean_abs", d.mean_abs}, {"max_abs", d.max_abs},
      {"p50_abs", d.p50_abs},   {"p95_abs", d.p95_abs},
      {"p99_abs", d.p99_abs},   {"negative_area_fraction", d.negative_area_fraction}};
  for (const auto& [key, value] : values) json[key] = number(value);
  return json;
}

nb::object extreme_numbers(const Extreme& extreme) {
  if (!std::isfinite(extreme.distance)) return nb::none();
  nb::dict json;
  json["distance"] = number(extreme.distance);
  json["point"] = numbers(extreme.point);
  json["at"] = extreme.at_vertex ? "vertex" : "texel";
  return json;
}

nb::dict tolerance_numbers(const ToleranceVerdict& verdict) {
  const auto [lo, hi] = verdict.tolerance;
  nb::dict json;
  json["value"] = lo == -hi ? number(hi) : nb::none();
  json["lower"] = lo;
  json["upper"] = hi;
  json["verdict"] = verdict.verdict == Verdict::pass   ? "PASS"
                    : verdict.verdict == Verdict::fail ? "FAIL"
                                                       : "NOT DECIDED";
  json["exceeded_area_fraction"] = verdict.exceeded_area_fraction;
  json["within"] = verdict.within;
  json["certified"] = verdict.certified;
  json["deciding_precision"] = verdict.deciding_bound > 0 ? number(verdict.deciding_bound) : nb::none();
  return json;
}

nb::dict color_numbers(const PictureOptions& fixed, bool given) {
  nb::dict json;
  const auto* name = std::ranges::find(kColormaps, fixed.colormap, &std::pair<const char*, Colormap>::second);
  json["map"] = fixed.colormap == Colormap::automatic ? "tolerance" : name->first;
  json["range"] = nb::make_tuple((*fixed.range)[0], (*fixed.range)[1]);
  json["range_from"] = given ? "option" : "p99_abs";
  return json;
}

using VertexDistances = nb::ndarray<const float, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

std::span<const float> span_of(const VertexDistances& values) {
  return {values.data(), values.shape(0)};
}

// What report.json states about a map, with its keys.
nb::dict report(const PyMap& self, const VertexDistances& at_vertices, const std::string& colormap,
                std::optional<std::pair<double, double>> range, nb::handle tolerance,
                const std::string& units) {
  const auto lock = self.use_surface();
  const auto sites_lock = self.use_sites();
  const PictureOptions picture = picture_of(self, {colormap, range, tolerance, units});
  const Surface& surface = self.on->surface;
  const bool of_itself = self.exclusion != nullptr;
  MeshInfo on, to;
  DistanceStatistics distance;
  double error_bound = 0;
  std::size_t boundary_texels = 0;
  std::optional<Extremes> places;
  std::optional<ToleranceVerdict> verdict;
  run(nb::none(), [&](const Progress&) {
    run_concurrently({[&] { on = inspect(surface.mesh()); },
                      [&] {
                        if (!of_itself) to = inspect(self.to->sites.mesh());
                      },
                      [&] { distance = statistics(surface, self.map); },
                      [&] { error_bound = covering_radius(surface); }});
    if (of_itself) return;
    if (!self.to->sites.closed())
      boundary_texels =
          static_cast<std::size_t>(std::ranges::count(boundary_mask(self.to->sites, self.map), 1));
    places = extremes(surface, self.map, span_of(at_vertices));
    if (picture.tolerance)
      verdict = check_tolerance(surface, self.map, span_of(at_vertices), error_bound, self.accuracy(),
                                *picture.tolerance);
  });

  nb::dict json;
  json["version"] = kVersion;
  if (of_itself) {
    json["mesh"] = mesh_numbers(on, "O1");
  } else {
    json["o1"] = mesh_numbers(on, "O1");
    json["o2"] = mesh_numbers(to, "O2");
    json["measured_on"] = "o1";
  }
  json["units"] = units;
  json["atlas"] = atlas_numbers(surface);
  json["engine"] = self.engine;
  json["max_distance"] = number(self.options.max_distance);
  json["colors"] = color_numbers(fixed_colors(picture, distance), range.has_value());
  json["distance"] = statistics_numbers(distance);
  json["texels_with_value"] = distance.texels;
  if (of_itself) {
    json["texels_without_value"] = self.map.beyond_max_distance;
    return json;
  }
  nb::dict sign, ends;
  sign["method"] = name_of(self.map.sign.method);
  sign["reason"] = self.map.sign.reason;
  json["sign"] = sign;
  ends["min"] = extreme_numbers(places->min);
  ends["max"] = extreme_numbers(places->max);
  json["extremes"] = ends;
  json["negative_texels"] = distance.negative_texels;
  json["beyond_max_distance"] = self.map.beyond_max_distance;
  json["boundary_texels"] = boundary_texels;
  json["accuracy"] = number(self.accuracy());
  json["accuracy_kind"] = "bounded";
  json["error_bound"] = number(error_bound);
  json["error_bound_kind"] = "bounded";
  if (verdict) json["tolerance"] = tolerance_numbers(*verdict);
  return json;
}

void write_page(const PyMap& self, nb::handle file, const VertexDistances& at_vertices,
                const std::string& report, const std::string& up, std::uint32_t largest,
                std::size_t triangles) {
  if (up != "y" && up != "z") throw Error("up must be 'y' or 'z', not '" + up + "'");
  const std::filesystem::path path = path_of(file);
  const auto lock = self.use_surface();
  const auto sites_lock = self.use_sites();
  HtmlOptions options{.other = self.exclusion ? nullptr : &self.to->sites.mesh(),
                      .up = up == "z" ? UpAxis::z : UpAxis::y,
                      .largest = largest,
                      .triangles = triangles};
  options.triangles_of_other = std::min(options.triangles_of_other, triangles);
  run(nb::none(), [&](const Progress&) {
    write_html(path, self.on->surface, self.map, span_of(at_vertices), report, options);
  });
}

}  // namespace

Colormap colormap_of(const std::string& name) {
  for (const auto& [known, value] : kColormaps)
    if (name == known) return value;
  throw Error("colormap must be one of automatic, viridis, diverging, paper2006, not '" + name + "'");
}

std::optional<std::array<double, 2>> range_of(const std::optional<std::pair<double, double>>& range) {
  if (!range) return {};
  if (!(range->first < range->second) || !std::isfinite(range->second - range->first))
    throw Error("range must be two finite numbers, the smaller one first");
  return std::array{range->first, range->second};
}

void bind_map_files(nb::module_& module, nb::class_<PyMap>& map) {
  module.def("can_write_html", &can_write_html);
  map.def("write", &write, nb::arg("format"), nb::arg("file").none(), nb::kw_only(),
          nb::arg("colormap") = "automatic", nb::arg("range") = nb::none(), nb::arg("tolerance") = nb::none(),
          nb::arg("units") = "", nb::arg("size") = 2048, nb::arg("progress") = nb::none(),
          nb::sig("def write(self, format: str, file: str, *, colormap: str = 'automatic', range: "
                  "tuple[float, float] | "
                  "None = None, tolerance: float | tuple[float, float] | None = None, units: str = '', "
                  "size: int = 2048, "
                  "progress: object = "
                  "None) -> None"))
      .def("report", &report, nb::arg("at_vertices"), nb::kw_only(), nb::arg("colormap") = "automatic",
           nb::arg("range") = nb::none(), nb::arg("tolerance") = nb::none(), nb::arg("units") = "",
           nb::sig("def report(self, at_vertices: numpy.ndarray, *, colormap: str = 'automatic', range: "
                   "tuple[float, float] | None = None, tolerance: float | tuple[float, float] | None = None, "
                   "units: str = '') -> dict[str, object]"))
      .def("write_page", &write_page, nb::arg("file"), nb::arg("at_vertices"), nb::arg("report"),
           nb::kw_only(), nb::arg("up") = "y", nb::arg("largest") = HtmlOptions{}.largest,
           nb::arg("triangles") = HtmlOptions{}.triangles,
           nb::sig("def write_page(self, file: str, at_vertices: numpy.ndarray, report: str, *, up: str = "
                   "'y', largest: int = 1024, triangles: int = 400000) -> None"));
}

}  // namespace sdm::python
