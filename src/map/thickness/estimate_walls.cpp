#include <sdm/mesh_edit.h>
#include <sdm/thickness.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <vector>

#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/vec.h"
#include "map/thickness/thickness_search.h"
#include "map/thickness/wall_lengths.h"

namespace sdm {
namespace {

// The sums of the areas of the faces up to each.
std::vector<double> area_sums(const Mesh& mesh) {
  std::vector<double> sums(mesh.triangles.size());
  double sum = 0;
  for (std::size_t f = 0; f < sums.size(); ++f) {
    if (!is_removed(mesh.triangles[f])) {
      const auto [a, b, c] = corners_of(mesh, f);
      sum += norm(cross(b - a, c - a)) / 2;
    }
    sums[f] = sum;
  }
  return sums;
}

// The i-th of a sequence of points that are evenly distributed over a triangle: M. Roberts, The unreasonable
// effectiveness of quasirandom sequences, 2018, folded at the diagonal of the square.
Vec3 point_in(const Corners& corners, std::size_t i) {
  constexpr double kFirst = 0.7548776662466927, kSecond = 0.5698402909980532;
  double whole = 0, s = std::modf(kFirst * static_cast<double>(i + 1), &whole),
         t = std::modf(kSecond * static_cast<double>(i + 1), &whole);
  if (s + t > 1) s = 1 - s, t = 1 - t;
  return corners[0] + s * (corners[1] - corners[0]) + t * (corners[2] - corners[0]);
}

}  // namespace

std::vector<double> thickness::wall_lengths(const Sites& sites, std::size_t samples) try {
  const sites::SitesData& data = internals(sites);
  if (samples == 0 || !data.closed || !data.orientation.orientable) return {};
  const thickness::Walls walls(data, ThicknessOptions().angle);
  const std::vector<double> sums = area_sums(data.mesh);
  const double step = sums.back() / static_cast<double>(samples);
  std::vector<double> lengths(samples, std::numeric_limits<double>::infinity());
  constexpr std::size_t kSampleGrain = 64;
  parallel_for(samples, kSampleGrain, [&](std::size_t begin, std::size_t end) {
    thickness::WallSearch search(walls);
    for (std::size_t i = begin; i < end; ++i) {
      const auto found = std::ranges::upper_bound(sums, (static_cast<double>(i) + 0.5) * step);
      const auto face = static_cast<std::uint32_t>(std::min(found, sums.end() - 1) - sums.begin());
      if (!walls.measures(face)) continue;
      lengths[i] = search.ray(face, point_in(corners_of(data.mesh, face), i)).thickness;
    }
  });
  std::ranges::sort(lengths);
  return lengths;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the walls of a solid");
}

double thickness::thin_walls(std::span<const double> lengths) {
  const std::size_t fewest = lengths.size() / 100 + 1;  // 1 %
  return lengths.empty() ? std::numeric_limits<double>::infinity() : lengths[fewest - 1];
}

std::optional<WallEstimate> thickness::estimate_walls(std::span<const double> lengths, double thin) {
  if (lengths.empty()) return std::nullopt;
  const auto count = static_cast<std::size_t>(std::ranges::lower_bound(lengths, thin) - lengths.begin());
  return WallEstimate{.thin = static_cast<double>(count) / static_cast<double>(lengths.size()),
                      .median = count == 0 ? 0 : lengths[count / 2],
                      .samples = lengths.size()};
}

double thin_walls(const Sites& sites) {
  return thickness::thin_walls(thickness::wall_lengths(sites));
}

std::optional<WallEstimate> estimate_walls(const Sites& sites, double thin, std::size_t samples) {
  return thickness::estimate_walls(thickness::wall_lengths(sites, samples), thin);
}

}  // namespace sdm
