#include "map/map_writer.h"

#include <algorithm>
#include <bit>

#include "atlas/layout.h"
#include "core/memory.h"
#include "core/parallel.h"

namespace sdm::map {

namespace {

void store_none(DistanceMap& map, std::size_t texel, std::size_t count, const NoValue& no_value = {}) {
  const float v = no_value.vector;
  std::fill_n(map.distance.data() + texel, count, no_value.distance);
  std::fill_n(map.vector.data() + texel, count, Vec3f{v, v, v});
  std::fill_n(map.site.data() + texel, count, kNone);
  std::fill_n(map.site_type.data() + texel, count, SiteType::none);
}

// Resizes the map; the values are unspecified.
void resize(DistanceMap& map, const Surface& surface) {
  const std::span<const std::uint32_t> faces = surface.map_faces();
  if (map.distance.capacity() < faces.size())
    require_memory(faces.size() * (sizeof(float) + sizeof(Vec3f) + sizeof(std::uint32_t) + sizeof(SiteType)),
                   "a map of " + atlas::size_text(surface.resolution(), surface.rows()) + " texels");
  map.resolution = surface.resolution();
  map.without_texel = faces.size() - surface.texel_faces().size();
  map.unmatched.clear();
  map.distance.resize(faces.size());
  map.vector.resize(faces.size());
  map.site.resize(faces.size());
  map.site_type.resize(faces.size());
}

constexpr std::size_t kClearGrain = 1 << 16;

}  // namespace

void clear(DistanceMap& map, const Surface& surface) {
  resize(map, surface);
  const std::span<const std::uint32_t> faces = surface.map_faces();
  parallel_for(faces.size(), kClearGrain, [&](std::size_t begin, std::size_t end) {
    const auto last = faces.begin() + static_cast<std::ptrdiff_t>(end);
    for (auto owned = faces.begin() + static_cast<std::ptrdiff_t>(begin); owned != last;) {
      const auto free = std::find(owned, last, kNone);
      owned = std::find_if(free, last, [](std::uint32_t face) { return face != kNone; });
      store_none(map, static_cast<std::size_t>(free - faces.begin()), static_cast<std::size_t>(owned - free));
    }
  });
}

void clear_all(DistanceMap& map, const Surface& surface) {
  resize(map, surface);
  parallel_for(map.distance.size(), kClearGrain,
               [&](std::size_t begin, std::size_t end) { store_none(map, begin, end - begin); });
}

MapWriter::MapWriter(DistanceMap& map, const NoValue& no_value) : map_(map), no_value_(no_value) {
  distance_ = map.distance.data();
  vector_ = map.vector.data();
  site_ = map.site.data();
  site_type_ = map.site_type.data();
}

std::size_t MapWriter::store(std::span<const std::uint32_t> texels, const sites::ClosestPacket& closest,
                             std::uint32_t inside) const {
  constexpr std::size_t kSize = sites::ClosestPacket::kSize;
  // Neighbours in space are scattered over the map: prefetch the texels that are written soon.
  constexpr std::size_t kAhead = 4 * kSize;
  for (std::size_t i = kAhead; i < std::min(kAhead + kSize, texels.size()); ++i) {
    __builtin_prefetch(distance_ + texels[i], 1);
    __builtin_prefetch(vector_ + texels[i], 1);
    __builtin_prefetch(site_ + texels[i], 1);
    __builtin_prefetch(site_type_ + texels[i], 1);
  }

  float distance[kSize], vector[3][kSize];
  for (std::size_t i = 0; i < kSize; ++i) distance[i] = static_cast<float>(closest.distance[i]);
  for (int k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < kSize; ++i) vector[k][i] = static_cast<float>(closest.vector[k][i]);
  for (; inside != 0; inside &= inside - 1) {
    float& d = distance[std::countr_zero(inside)];
    d = -d;
  }

  const std::uint32_t* texel = texels.data();
  std::size_t without = 0;
  for (std::size_t i = 0; i < closest.count; ++i) {
    distance_[texel[i]] = distance[i];
    vector_[texel[i]] = {vector[0][i], vector[1][i], vector[2][i]};
    site_[texel[i]] = closest.site[i];
    site_type_[texel[i]] = closest.type[i];
    without += closest.type[i] == SiteType::none;
  }
  for (std::size_t i = 0; without > 0 && i < closest.count; ++i)
    if (closest.type[i] == SiteType::none) store_none(map_, texel[i], 1, no_value_);
  return without;
}

}  // namespace sdm::map
