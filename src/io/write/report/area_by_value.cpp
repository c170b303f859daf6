#include "io/write/report/area_by_value.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/geometry/vec.h"
#include "core/parallel.h"

namespace sdm::io {
namespace {

constexpr std::size_t kKeys = 1 << 16;
constexpr std::size_t kParts = 4;  // whose sums are added in order, whatever the number of threads

std::uint32_t key_of(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return (bits ^ (bits >> 31 ? 0xFFFFFFFFu : 0x80000000u)) >> 16;
}

// The area of a texel of each face, relative to the largest, so that sums are finite for meshes of any size.
std::vector<double> texel_areas(const Surface& surface) {
  const auto charts = surface.face_charts();
  std::vector<double> areas(charts.size());
  for (std::uint32_t face = 0; face < charts.size(); ++face) {
    if (charts[face] == kNone) continue;
    const auto [du, dv] = surface.texel_edges(face);
    areas[face] = norm(cross(du, dv));
  }
  const double largest = areas.empty() ? 0 : *std::ranges::max_element(areas);
  for (double& area : areas) area = largest > 0 ? area / largest : 0;
  return areas;
}

std::vector<float> fractions(std::span<const double> areas, double total) {
  std::vector<float> result;
  for (const double area : areas) result.push_back(static_cast<float>(total > 0 ? area / total : 0));
  return result;
}

}  // namespace

AreaByValue area_by_value(const Surface& surface, const DistanceMap& map) {
  AreaByValue result;
  const auto owners = surface.texel_faces();
  const auto samples = surface.sample_texels();
  result.lo = std::numeric_limits<double>::infinity(), result.hi = -result.lo;
  for (const std::uint32_t texel : samples)
    if (const double d = map.distance[texel]; std::isfinite(d))
      result.lo = std::min(result.lo, d), result.hi = std::max(result.hi, d);
  if (result.lo > result.hi) result.lo = result.hi = 0;

  const std::vector<double> areas = texel_areas(surface);
  const double per_unit = result.hi > result.lo ? AreaByValue::kBins / (result.hi - result.lo) : 0;
  struct Sums {
    std::vector<double> by_key = std::vector<double>(kKeys), by_bin = std::vector<double>(AreaByValue::kBins);
  };
  std::vector<Sums> parts(kParts);
  parallel_for(kParts, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t part = begin; part < end; ++part)
      for (std::size_t i = part * samples.size() / kParts; i < (part + 1) * samples.size() / kParts; ++i) {
        const float d = map.distance[samples[i]];
        if (!std::isfinite(d)) continue;
        const double area = areas[owners[samples[i]]];
        const auto bin = static_cast<std::size_t>((d - result.lo) * per_unit);
        parts[part].by_key[key_of(d)] += area;
        parts[part].by_bin[std::min(bin, AreaByValue::kBins - 1)] += area;
      }
  });
  Sums& all = parts[0];
  for (std::size_t part = 1; part < kParts; ++part) {
    std::ranges::transform(all.by_key, parts[part].by_key, all.by_key.begin(), std::plus());
    std::ranges::transform(all.by_bin, parts[part].by_bin, all.by_bin.begin(), std::plus());
  }
  double total = 0;
  for (const double area : all.by_bin) total += area;
  result.area = fractions(all.by_bin, total);
  std::vector<double> used;
  for (std::uint32_t key = 0; key < kKeys; ++key)
    if (all.by_key[key] > 0) result.keys.push_back(key), used.push_back(all.by_key[key]);
  result.area_of_key = fractions(used, total);
  return result;
}

}  // namespace sdm::io
