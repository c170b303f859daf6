#include "map/measures/walls.h"

#include <sdm/error.h>
#include <sdm/measure.h>
#include <sdm/mesh_edit.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <new>
#include <vector>

#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/vec.h"
#include "map/measures/thickness_measure.h"

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
  if (s + t > 1) {
    s = 1 - s;
    t = 1 - t;
  }
  return corners[0] + s * (corners[1] - corners[0]) + t * (corners[2] - corners[0]);
}

}  // namespace

std::vector<double> thickness::wall_lengths(const Sites& sites, std::size_t samples) try {
  const sites::SitesData& data = internals(sites);
  if (samples == 0 || !data.closed || !data.orientation.orientable) return {};
  const thickness::Walls walls(data, ThicknessMethod::ray, ThicknessOptions().angle);
  const std::vector<double> sums = area_sums(data.mesh);
  const double step = sums.back() / static_cast<double>(samples);
  std::vector<double> lengths(samples, kInfinity);
  constexpr std::size_t kSampleGrain = 64;
  parallel_for(samples, kSampleGrain, [&](std::size_t begin, std::size_t end) {
    thickness::WallSearch search(walls);
    for (std::size_t i = begin; i < end; ++i) {
      const auto found = std::ranges::upper_bound(sums, (static_cast<double>(i) + 0.5) * step);
      const auto face = static_cast<std::uint32_t>(std::min(found, sums.end() - 1) - sums.begin());
      if (!walls.measures(face)) continue;
      lengths[i] = search.ray({face, point_in(corners_of(data.mesh, face), i)}).thickness;
    }
  });
  std::ranges::sort(lengths);
  return lengths;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the walls of a solid");
}

double thickness::thin_walls(std::span<const double> lengths) {
  const std::size_t fewest = lengths.size() / 100 + 1;  // 1 %
  return lengths.empty() ? kInfinity : lengths[fewest - 1];
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

namespace {

/// The first texels in an order of their values, apart from each other.
template <class Before>
std::vector<std::uint32_t> first_texels(const Surface& surface, const DistanceMap& map, std::size_t count,
                                        const Before& before) {
  if (map.distance.size() != surface.map_faces().size()) throw Error("the map belongs to another surface");
  constexpr double kApart = 0.06;  // of the diagonal, as the places of pages
  const double apart = kApart * diagonal(bounds(surface.mesh()));
  std::vector<std::uint32_t> texels;
  for (const std::uint32_t texel : surface.sample_texels())
    if (std::isfinite(map.distance[texel])) texels.push_back(texel);
  std::ranges::stable_sort(texels, before, [&](std::uint32_t texel) { return map.distance[texel]; });
  std::vector<std::uint32_t> places;
  for (const std::uint32_t texel : texels) {
    if (places.size() >= count) break;
    const Vec3 p = surface.texel_point(texel);
    const auto near = [&](std::uint32_t place) { return norm(surface.texel_point(place) - p) < apart; };
    if (std::ranges::none_of(places, near)) places.push_back(texel);
  }
  return places;
}

}  // namespace

std::vector<std::uint32_t> thinnest_texels(const Surface& surface, const DistanceMap& map,
                                           std::size_t count) {
  return first_texels(surface, map, count, std::ranges::less());
}

std::vector<std::uint32_t> thickest_texels(const Surface& surface, const DistanceMap& map,
                                           std::size_t count) {
  return first_texels(surface, map, count, std::ranges::greater());
}

double thickness_accuracy(const Mesh& mesh) {
  return 1e-7 * diagonal(bounds(mesh));  // a float is rounded by 6e-8
}

}  // namespace sdm
