#include "io/page/report/worst_places.h"

#include <sdm/mesh_edit.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/parallel.h"
#include "geometry/vec.h"

namespace sdm::io {
namespace {

constexpr std::size_t kMost = 10;  // places
constexpr std::size_t kPartsOfSamples = 16;
// The sample of the largest |distance| stands for so many, which are close together on the surface.
constexpr std::size_t kRun = 64;

}  // namespace

LargestByCell::LargestByCell(const Box& box)
    : lo_(box.lo), width_(kApart * diagonal(box)), places_(kSide * kSide * kSide) {}

void LargestByCell::add(const Place& place) {
  if (!std::isfinite(place.distance)) return;
  Place& largest = places_[cell(place.point)];
  // The first one of equals stays, so that the result does not depend on the number of threads.
  if (largest.distance == 0 || std::abs(place.distance) > std::abs(largest.distance)) largest = place;
}

void LargestByCell::add(const LargestByCell& other) {
  for (const Place& place : other.places_)
    if (place.distance != 0) add(place);
}

std::vector<Place> LargestByCell::largest() const {
  std::vector<Place> result;
  std::ranges::copy_if(places_, std::back_inserter(result), [](const Place& p) { return p.distance != 0; });
  std::ranges::stable_sort(result, std::greater(), [](const Place& p) { return std::abs(p.distance); });
  return result;
}

std::size_t LargestByCell::cell(const Vec3& p) const {
  std::size_t index = 0;
  for (int k = 0; k < 3; ++k) {
    const double at = width_ > 0 ? (p[k] - lo_[k]) / width_ : 0;
    index = index * kSide + static_cast<std::size_t>(std::clamp(at, 0.0, kSide - 1.0));
  }
  return index;
}

std::vector<Place> worst_places(const LargestByCell& cells) {
  std::vector<Place> result;
  for (const Place& place : cells.largest()) {
    if (result.size() == kMost) break;
    const auto near = [&](const Place& p) { return norm(p.point - place.point) < cells.width(); };
    if (std::ranges::none_of(result, near)) result.push_back(place);
  }
  return result;
}

std::vector<Place> worst_places(const Surface& surface, const DistanceMap& map,
                                std::span<const float> vertex_distances) {
  const Mesh& mesh = surface.mesh();
  const Box box = bounds(mesh);
  const auto samples = surface.sample_texels();
  const std::size_t runs = (samples.size() + kRun - 1) / kRun;
  const auto size = [&](std::uint32_t texel) {
    const float d = map.distance[texel];
    return std::isfinite(d) ? std::abs(d) : -1;
  };
  std::vector<LargestByCell> parts(kPartsOfSamples, LargestByCell(box));
  parallel_for(kPartsOfSamples, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t part = begin; part < end; ++part)
      for (std::size_t run = part * runs / kPartsOfSamples; run < (part + 1) * runs / kPartsOfSamples;
           ++run) {
        const auto texels = samples.subspan(run * kRun, std::min(kRun, samples.size() - run * kRun));
        const std::uint32_t texel = *std::ranges::max_element(texels, {}, size);
        if (size(texel) > 0) parts[part].add({map.distance[texel], surface.texel_point(texel), texel});
      }
  });
  LargestByCell all(box);
  for (const LargestByCell& part : parts) all.add(part);
  for (const Triangle& triangle : mesh.triangles) {
    if (is_removed(triangle)) continue;
    for (const std::uint32_t v : triangle) all.add({vertex_distances[v], mesh.positions[v], kNone});
  }

  return worst_places(all);
}

}  // namespace sdm::io
