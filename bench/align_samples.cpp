// Times an alignment, and writes the vertices of both meshes for other libraries, for bench/peers.
#include <sdm/sdm.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <random>
#include <vector>

#include "arrays.h"
#include "geometry/vec.h"
#include "refine_mesh.h"
#include "samples.h"
#include "scenes.h"
#include "timing.h"

namespace sdm::bench {
namespace {

/// O1 as a scanner delivers it: with noise, without the faces that lie farthest along a direction, with
/// points in space.
Mesh scanned(Mesh mesh, double noise, double missing, double outliers) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const Box box = bounds(mesh);
  const double size = diagonal(box);
  for (Vec3& p : mesh.positions)
    for (double& x : p) x += noise * size * normal(random);
  const auto height = [&](const Triangle& t) { return dot(mesh.positions[t[0]], Vec3{0.3, 0.5, 0.8}); };
  std::ranges::sort(mesh.triangles, {}, height);
  mesh.triangles.resize(static_cast<std::size_t>((1 - missing) * static_cast<double>(mesh.triangles.size())));
  std::uniform_real_distribution<double> unit;
  const auto apart = static_cast<std::size_t>(outliers * static_cast<double>(mesh.triangles.size()));
  for (std::size_t i = 0; i < apart; ++i) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    Vec3 p;
    for (int k = 0; k < 3; ++k) p[k] = box.lower[k] + unit(random) * (box.upper[k] - box.lower[k]);
    const double side = 0.003 * size;
    for (const Vec3& offset : {Vec3{}, Vec3{side, 0, 0}, Vec3{0, side, 0}})
      mesh.positions.push_back(p + offset);
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

std::vector<Vec3> used_vertices(const Mesh& mesh) {
  std::vector<std::uint8_t> used(mesh.positions.size(), 0);
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) used[v] = 1;
  std::vector<Vec3> result;
  for (std::size_t v = 0; v < used.size(); ++v)
    if (used[v]) result.push_back(mesh.positions[v]);
  return result;
}

struct AlignSamples {
  std::string name;
  std::filesystem::path out;
  std::uint32_t parts = 1;
  double noise = 0, missing = 0, outliers = 0;
};

void write_align_samples(const AlignSamples& options) {
  const auto& [name, out, parts, noise, missing, outliers] = options;

  const Mesh mesh = refine_mesh(load(name, "fit"), parts, parts > 1 ? 0.1 : 0);
  const Sites sites(mesh);
  const double size = diagonal(bounds(mesh)), shift = 0.02 * size / std::sqrt(3);
  const Transform motion =
      Transform::translation({shift, -shift, shift}) * Transform::rotation({1.2, 1.2, -1.2});
  Mesh o1 = scanned(mesh, noise, missing, outliers);
  transform(o1, motion);

  Alignment found;
  const Contender ours{[&] { found = align(o1, sites); }, 1};
  const double ms = median(take_turns(std::array{ours}, 5)[0]);
  double error = 0;
  const Box box = bounds(mesh);
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 p;
    for (int k = 0; k < 3; ++k) p[k] = corner >> k & 1 ? box.upper[k] : box.lower[k];
    error = std::max(error, norm((found.transform * motion)(p)-p) / size);
  }
  write_array<Vec3>(out / "vertices1", used_vertices(o1));
  write_array<Vec3>(out / "vertices2", mesh.positions);
  write_array<Triangle>(out / "triangles2", mesh.triangles);
  std::vector<double> matrix;
  for (const auto& row : motion.rows) matrix.insert(matrix.end(), row.begin(), row.end());
  write_array<double>(out / "motion", matrix);
  std::cout << o1.triangles.size() << ' ' << mesh.triangles.size() << ' ' << ms << ' ' << error << '\n';
}

}  // namespace

void add_align(CLI::App& program) {
  CLI::App& app = *program.add_subcommand(
      "align",
      "Aligns a mesh, turned by 2 degrees and moved by 2 % of its size, to itself on all cores. Prints the "
      "triangles of both, the milliseconds, and the largest error of a corner of the bounds relative to the "
      "size. Writes arrays without headers into OUT: vertices1, vertices2, motion (4 × 4, row by row; all "
      "float64) and triangles2 (uint32).");
  const auto options = std::make_shared<AlignSamples>();
  app.add_option("MESH", options->name, "A mesh of the benchmarks")->required();
  app.add_option("PARTS", options->parts, "Triangles are divided into PARTS² triangles")->required();
  app.add_option("NOISE", options->noise, "Standard deviation of O1, relative to its size")->required();
  app.add_option("MISSING", options->missing, "Share of the triangles that O1 lacks")->required();
  app.add_option("OUTLIERS", options->outliers, "Share of triangles in space that O1 has besides")
      ->required();
  app.add_option("OUT", options->out)->required();
  app.callback([options] { write_align_samples(*options); });
}

}  // namespace sdm::bench
