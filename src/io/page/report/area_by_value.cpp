#include "io/page/report/area_by_value.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/parallel.h"
#include "map/statistics/texel_areas.h"

namespace sdm::io {
namespace {

constexpr std::size_t kKeys = 1 << 16;
constexpr std::size_t kParts = 4;  // whose sums are added in order, whatever the number of threads

std::uint32_t key_of(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return (bits ^ (bits >> 31 ? 0xFFFFFFFFu : 0x80000000u)) >> 16;
}

// The area of a sample of each face, relative to the largest, so that sums are finite for meshes of any size.
std::vector<double> relative_texel_areas(const Surface& surface) {
  std::vector<double> areas = map::texel_areas(surface);
  const double largest = areas.empty() ? 0 : *std::ranges::max_element(areas);
  for (double& area : areas) area = largest > 0 ? area / largest : 0;
  return areas;
}

std::vector<float> fractions_of(std::span<const double> areas, double total) {
  std::vector<float> result;
  for (const double area : areas) result.push_back(static_cast<float>(total > 0 ? area / total : 0));
  return result;
}

}  // namespace

AreaSums::AreaSums(double lo, double hi)
    : lo_(lo),
      hi_(hi),
      bins_per_unit_(hi > lo ? AreaByValue::kBins / (hi - lo) : 0),
      by_key_(kKeys),
      by_bin_(AreaByValue::kBins) {}

void AreaSums::add(float distance, double area) {
  const auto bin = static_cast<std::size_t>((distance - lo_) * bins_per_unit_);
  by_key_[key_of(distance)] += area;
  by_bin_[std::min(bin, AreaByValue::kBins - 1)] += area;
}

void AreaSums::add(const AreaSums& other) {
  without_value_ += other.without_value_;
  std::ranges::transform(by_key_, other.by_key_, by_key_.begin(), std::plus());
  std::ranges::transform(by_bin_, other.by_bin_, by_bin_.begin(), std::plus());
}

AreaByValue AreaSums::fractions() const {
  AreaByValue result;
  result.lower = lo_;
  result.upper = hi_;
  double total = without_value_;
  for (const double area : by_bin_) total += area;
  result.area = fractions_of(by_bin_, total);
  result.without_value = total > 0 ? without_value_ / total : 0;
  std::vector<double> used;
  for (std::uint32_t key = 0; key < kKeys; ++key)
    if (by_key_[key] > 0) {
      result.keys.push_back(key);
      used.push_back(by_key_[key]);
    }
  result.area_of_key = fractions_of(used, total);
  return result;
}

AreaByValue area_by_value(const Surface& surface, const DistanceMap& map) {
  const auto owners = surface.map_faces();
  const auto samples = surface.sample_texels();
  double lo = kInfinity, hi = -lo;
  for (const std::uint32_t texel : samples)
    if (const double d = map.distance[texel]; std::isfinite(d)) {
      lo = std::min(lo, d);
      hi = std::max(hi, d);
    }
  if (lo > hi) lo = hi = 0;

  const std::vector<double> areas = relative_texel_areas(surface);
  std::vector<AreaSums> parts(kParts, AreaSums(lo, hi));
  parallel_for(kParts, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t part = begin; part < end; ++part)
      for (std::size_t i = part * samples.size() / kParts; i < (part + 1) * samples.size() / kParts; ++i)
        if (const float d = map.distance[samples[i]]; std::isfinite(d))
          parts[part].add(d, areas[owners[samples[i]]]);
        else
          parts[part].add_without_value(areas[owners[samples[i]]]);
  });
  for (std::size_t part = 1; part < kParts; ++part) parts[0].add(parts[part]);
  return parts[0].fractions();
}

}  // namespace sdm::io
