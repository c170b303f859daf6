#include <sdm/error.h>
#include <sdm/thickness.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "geometry/vec.h"

namespace sdm {
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
