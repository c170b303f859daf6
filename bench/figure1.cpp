// A scene like the paper's Figure 1: surface distance maps of a figure in a box, in both directions, at 256²
// texels. Writes to DIR the meshes, three pictures of each map, and figure1.png, which shows the figure in
// its box with the distances, Voronoi diagrams and directions of both maps.
//
//   build/release/bench/figure1 [--engine gl|cpu] [DIR]
#include <sdm/error.h>
#include <sdm/io.h>
#include <sdm/sdm.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>

#include "io/write/atomic_file.h"
#include "io/write/pictures/color_scale.h"
#include "io/write/pictures/legend.h"
#include "io/write/pictures/png.h"
#include "scenes.h"
#include "visible_texels.h"

namespace sdm::bench {
namespace {

using namespace io;

constexpr std::uint32_t kResolution = 256;
constexpr std::uint32_t kPanelWidth = 315, kPanelHeight = 504, kSubsamples = 2;
constexpr Rgb kPaper{255, 255, 255};

/// A mesh with the map of its distances to the other mesh.
struct Side {
  std::string name;
  Surface surface;
  Sites sites;
  DistanceMap map{};
  std::optional<GlReport> report{};  ///< of the gl engine

  Side(std::string its_name, const Mesh& mesh)
      : name(std::move(its_name)), surface(mesh, {.resolution = kResolution}), sites(mesh) {}

  /// Computes the unsigned map, as in the paper. Returns the time in milliseconds, without that of opening
  /// the device.
  double measure(const Sites& to, const std::shared_ptr<const Engine>& engine) {
    const auto start = std::chrono::steady_clock::now();
    map = compute_map(surface, to, {.engine = engine, .sign = SignMethod::none});
    const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
    report = gl_report(*engine);
    return time.count() - (report ? report->time_ms.context : 0);
  }
};

void write_obj(const std::filesystem::path& path, const Mesh& mesh) {
  AtomicFile file(path);
  file.stream().precision(17);
  for (const auto& [x, y, z] : mesh.positions) file.stream() << "v " << x << ' ' << y << ' ' << z << '\n';
  for (const auto& [a, b, c] : mesh.triangles)
    file.stream() << "f " << a + 1 << ' ' << b + 1 << ' ' << c + 1 << '\n';
  file.commit();
}

/// A common scale for both maps, so that a colour means the same distance on the figure and on its box.
ColorScale common_scale(const Side& a, const Side& b) {
  const DistanceStatistics on_a = statistics(a.surface, a.map), on_b = statistics(b.surface, b.map);
  return {.map = Colormap::paper2006, .lo = std::min(on_a.min, on_b.min), .hi = std::max(on_a.max, on_b.max)};
}

/// The pixels of a panel: averages of the camera's samples, each the colour of its texel times its light.
Picture paint(std::span<const Seen> seen, const std::function<Rgb(const Seen&)>& color) {
  Picture panel{kPanelWidth, kPanelHeight, std::vector<Rgb>(std::size_t{kPanelWidth} * kPanelHeight)};
  for (std::uint32_t y = 0; y < kPanelHeight; ++y)
    for (std::uint32_t x = 0; x < kPanelWidth; ++x) {
      std::array<float, 3> sum{};
      for (std::uint32_t sample = 0; sample < kSubsamples * kSubsamples; ++sample) {
        const std::uint32_t row = y * kSubsamples + sample / kSubsamples;
        const std::uint32_t column = x * kSubsamples + sample % kSubsamples;
        const Seen& s = seen[std::size_t{row} * kPanelWidth * kSubsamples + column];
        const Rgb c = s.texel == kNone ? kPaper : color(s);
        const float light = s.texel == kNone ? 1 : 0.6f + 0.4f * s.light;
        sum[0] += light * c.r, sum[1] += light * c.g, sum[2] += light * c.b;
      }
      const auto mean = [](float total) {
        return static_cast<std::uint8_t>(std::floor(total / (kSubsamples * kSubsamples) + 0.5f));
      };
      panel.pixels[y * kPanelWidth + x] = {mean(sum[0]), mean(sum[1]), mean(sum[2])};
    }
  return panel;
}

/// Writes the pictures side by side.
void write_row(const std::filesystem::path& path, std::span<const Picture> pictures) {
  std::uint32_t width = 0;
  for (const Picture& picture : pictures) width += picture.width;
  AtomicFile file(path);
  write_png(file.stream(), width, kPanelHeight, [&](std::uint32_t y, std::span<Rgb> row) {
    for (const Picture& picture : pictures) {
      if (y < picture.height)
        std::copy_n(&picture.pixels[std::size_t{y} * picture.width], picture.width, row.begin());
      else
        std::fill_n(row.begin(), picture.width, kPaper);
      row = row.subspan(picture.width);
    }
  });
  file.commit();
}

void draw(const std::filesystem::path& path, const Side& figure, const Side& box, const ColorScale& scale) {
  const View view{.eye = {1.3, -3.1, 0.95},
                  .target = {0, 0, 0},
                  .field_of_view = 24.5,
                  .width = kPanelWidth * kSubsamples,
                  .height = kPanelHeight * kSubsamples};
  const std::array shown{Shown{&figure.surface}, Shown{&box.surface, true}};
  const std::vector<Seen> seen = visible_texels(view, shown);

  const std::array maps{&figure.map, &box.map};
  const std::array pictures{
      paint(seen, [&](const Seen& s) { return scale(maps[s.object]->distance[s.texel]); }),
      draw_legend(scale, LegendText{"Distance", {}, {}}, kPanelHeight),
      paint(seen,
            [&](const Seen& s) {
              return site_color(maps[s.object]->site_type[s.texel], maps[s.object]->site[s.texel]);
            }),
      paint(seen, [&](const Seen& s) { return direction_color(maps[s.object]->vector[s.texel]); }),
  };
  write_row(path, pictures);
}

int run(int argc, char** argv) {
  std::filesystem::path folder = "out/figure1";
  CLI::App app{
      "A scene like the paper's Figure 1: surface distance maps of a figure in a box, in both directions"};
  std::string engine_name = "gl";
  app.add_option("--engine", engine_name, "The engine that computes the maps")
      ->check(CLI::IsMember({"gl", "cpu"}))
      ->option_text("gl|cpu [gl]");
  app.add_option("DIR", folder, "Where the pictures go")->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  const std::shared_ptr<const Engine> engine = make_engine(engine_name);
  std::error_code fault;
  std::filesystem::create_directories(folder, fault);
  if (fault) throw Error("cannot make the folder " + folder.string() + ": " + fault.message());

  const Mesh man = paper_figure();
  Side figure("figure", man), box("box", paper_box(man));
  for (const auto& [on, to] : {std::pair(&figure, &box), std::pair(&box, &figure)}) {
    const double ms = on->measure(to->sites, engine);
    std::printf("%zu triangles to %zu: %zu texels in %.1f ms on %s\n", on->surface.mesh().triangles.size(),
                to->surface.mesh().triangles.size(), on->surface.sample_texels().size(), ms,
                on->report ? on->report->device.name.c_str() : "the processor");
  }

  const ColorScale scale = common_scale(figure, box);
  const PictureOptions options{.colormap = scale.map, .range = {{scale.lo, scale.hi}}};
  for (const Side* side : {&figure, &box}) {
    std::filesystem::create_directories(folder / side->name);
    write_obj(folder / (side->name + ".obj"), side->surface.mesh());
    write_distance_png(folder / side->name / "distance.png", side->surface, side->map, options);
    write_voronoi_png(folder / side->name / "voronoi.png", side->surface, side->map);
    write_direction_png(folder / side->name / "direction.png", side->surface, side->map);
  }
  draw(folder / "figure1.png", figure, box, scale);
  std::printf("The picture is %s; the meshes and their maps are beside it.\n",
              (folder / "figure1.png").c_str());
  return 0;
}

}  // namespace
}  // namespace sdm::bench

int main(int argc, char** argv) try {
  return sdm::bench::run(argc, argv);
} catch (const std::exception& error) {
  std::fprintf(stderr, "figure1: %s\n", error.what());
  return 1;
}
