// The files of a map, and the numbers of its page.
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <sdm/map_files.h>
#include <sdm/mesh_files.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "map.h"
#include "options.h"

namespace sdm::python {
namespace {

PictureOptions picture_of(const PyMap& self, const nb::dict& given) {
  PictureOptions picture;
  set_options(given, picture);
  if (picture.tolerance) require_sign(*picture.tolerance, self.map.sign.method);
  // Self maps are exact but for rounding to float.
  if (!self.exclusion) picture.accuracy = self.accuracy();
  return picture;
}

// Where a map comes from, for its files: meshes of Python have no names but their roles.
MapReport origin_of(const PyMap& self) {
  MapReport origin{
      .on = {.file = "O1"}, .to = {.file = self.of_itself() ? "O1" : "O2"}, .engine = self.engine};
  origin.time_ms.map = self.ms;
  return origin;
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

void write(const PyMap& self, const std::string& format, nb::handle file, const nb::dict& given,
           nb::handle progress) {
  const auto lock = self.use_surface();
  const auto sites_lock = self.use_sites();
  const PictureOptions picture = picture_of(self, given);
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
      if (!self.to->sites.closed()) boundary = boundary_mask(self.to->sites, self.map);
      const MapReport origin = origin_of(self);
      write_exr(path, surface, self.map,
                {.boundary = boundary, .attributes = exr_attributes(origin, self.map, picture.units)});
    } else if (format == "glb") {
      write_glb(path, surface, self.map, self.vertex_distances(report), picture);
    } else {
      write_distance_png(path, surface, self.map, picture);
    }
  });
}

using VertexDistances = nb::ndarray<const float, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

std::span<const float> span_of(const VertexDistances& values) {
  return {values.data(), values.shape(0)};
}

// Three numbers, in a tuple, a list or an array.
Vec3 direction_of(nb::handle towards) {
  if (!nb::isinstance<nb::sequence>(towards) && !nb::ndarray_check(towards))
    throw Error("towards must be three numbers: right, up, front");
  if (nb::len(towards) != 3) throw Error("towards must be three numbers: right, up, front");
  return {real_of(towards[0]), real_of(towards[1]), real_of(towards[2])};
}

void write_view(const PyMap& self, nb::handle file, const VertexDistances& at_vertices, nb::handle towards,
                const std::optional<VertexDistances>& other, const nb::dict& given, nb::handle size,
                bool legend) {
  const auto lock = self.use_surface();
  const auto sites_lock = self.use_sites();
  const PictureOptions picture = picture_of(self, given);
  const std::filesystem::path path = path_of(file);
  const auto width = static_cast<std::uint32_t>(integer_of(size, "size", 86, 8192));
  ViewOptions view{
      .towards = direction_of(towards), .width = width, .height = 3 * width / 4, .legend = legend};
  if (!self.of_itself()) view.other = &self.to->sites.mesh();
  if (other) view.other_distances = span_of(*other);
  run(nb::none(), [&](const Progress&) {
    write_view_png(path, self.on->surface, self.map, span_of(at_vertices), view, picture);
  });
}

// The text of report.json.
std::string report(const PyMap& self, const VertexDistances& at_vertices, const nb::dict& given) {
  const auto lock = self.use_surface();
  const auto sites_lock = self.use_sites();
  const Surface& surface = self.on->surface;
  const Sites& sites = self.to->sites;
  SummaryOptions options;
  set_options(given, options);
  if (options.tolerance) require_sign(*options.tolerance, self.map.sign.method);
  options.max_distance = self.options.max_distance;
  if (!self.exclusion) {
    options.accuracy = self.accuracy();
    options.guard = self.guard();
  }
  MapReport origin = origin_of(self);
  std::string text;
  run(nb::none(), [&](const Progress&) {
    origin.on.info = inspect(surface.mesh());
    if (self.thickness) {
      text = report_json(origin, surface, summarize_thickness(surface, self.map, options));
      return;
    }
    if (self.exclusion) {
      text = report_json(origin, surface, summarize_self(surface, self.map, options));
      return;
    }
    Summary summary;
    run_concurrently({[&] { origin.to.info = inspect(sites.mesh()); },
                      [&] {
                        if (self.map.sign.method == SignMethod::exact) origin.embedded = is_embedded(sites);
                      },
                      [&] { summary = summarize(surface, sites, self.map, span_of(at_vertices), options); }});
    text = report_json(origin, surface, summary);
  });
  return text;
}

// The colours of pictures: the name of the colour map, the distances at its ends, and the colours from one to
// the other; the last one is that of no value.
nb::object colors(const PyMap& self) {
  constexpr int kSteps = 1024;
  const auto lock = self.use_surface();
  const PictureOptions picture = picture_of(self, {});
  const PictureOptions fixed =
      run_short([&] { return fixed_colors(picture, statistics(self.on->surface, self.map)); });
  const auto [low, high] = *fixed.range;
  std::vector<std::array<std::uint8_t, 3>> colors;
  for (int i = 0; i < kSteps; ++i) colors.push_back(color_of(fixed, low + (i + 0.5) / kSteps * (high - low)));
  colors.push_back(color_of(fixed, std::numeric_limits<double>::quiet_NaN()));
  return nb::make_tuple(sdm::name_of(fixed.colormap), low, high,
                        array_of<std::uint8_t>(std::move(colors), {kSteps + 1, 3}));
}

void write_page(const PyMap& self, nb::handle file, const VertexDistances& at_vertices,
                const std::string& report, const std::string& up, std::uint32_t largest,
                std::size_t triangles) {
  if (up != "y" && up != "z") throw Error("up must be 'y' or 'z', not '" + up + "'");
  const std::filesystem::path path = path_of(file);
  const auto lock = self.use_surface();
  const auto sites_lock = self.use_sites();
  HtmlOptions options{.other = self.of_itself() ? nullptr : &self.to->sites.mesh(),
                      .up = enum_of<UpAxis>("up", up),
                      .places = self.thickness.has_value() || self.of_itself() ? ListedPlaces::least
                                                                               : ListedPlaces::deviating,
                      .largest = largest,
                      .triangles = triangles};
  options.triangles_of_other = std::min(options.triangles_of_other, triangles);
  run(nb::none(), [&](const Progress&) {
    write_html(path, self.on->surface, self.map, span_of(at_vertices), report, options);
  });
}

}  // namespace

void bind_map_files(nb::module_& module, nb::class_<PyMap>& map) {
  module.def("can_write_html", &can_write_html);
  map.def("write", &write, nb::arg("format"), nb::arg("file").none(), nb::arg("options"), nb::kw_only(),
          nb::arg("progress") = nb::none(),
          nb::sig("def write(self, format: str, file: str, options: dict[str, object], *, progress: object = "
                  "None) -> None"))
      .def("report", &report, nb::arg("at_vertices"), nb::arg("options"),
           nb::sig("def report(self, at_vertices: numpy.typing.NDArray[typing.Any], options: dict[str, "
                   "object]) -> str"))
      .def("colors", &colors,
           nb::sig("def colors(self) -> tuple[str, float, float, numpy.typing.NDArray[numpy.uint8]]"))
      .def("write_view", &write_view, nb::arg("file"), nb::arg("at_vertices"), nb::arg("towards"),
           nb::arg("other").none(), nb::arg("options"), nb::kw_only(), nb::arg("size"), nb::arg("legend"),
           nb::sig("def write_view(self, file: str, at_vertices: numpy.typing.NDArray[typing.Any], towards: "
                   "tuple[float, float, float], other: numpy.typing.NDArray[typing.Any] | None, options: "
                   "dict[str, object], *, size: int, legend: bool) -> None"))
      .def("write_page", &write_page, nb::arg("file"), nb::arg("at_vertices"), nb::arg("report"),
           nb::kw_only(), nb::arg("up") = "y", nb::arg("largest") = HtmlOptions{}.largest,
           nb::arg("triangles") = HtmlOptions{}.triangles,
           nb::sig("def write_page(self, file: str, at_vertices: numpy.typing.NDArray[typing.Any], report: "
                   "str, *, up: str = "
                   "'y', largest: int = 1024, triangles: int = 400000) -> None"));
}

}  // namespace sdm::python
