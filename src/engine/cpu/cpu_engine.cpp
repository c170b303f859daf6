// The CPU engine: points in packets against the wide tree, in the unit frame of O2 and single precision; then
// the winner in double.
#include <algorithm>
#include <cmath>

#include "core/vec.h"
#include "engine/closest_on_face.h"
#include "engine/cpu/packet.h"
#include "engine/engine.h"

namespace sdm {
namespace {

// Beyond this many sizes of O2 squares come near the end of single precision. The reference engine is slow there,
// since no box is nearer than another, but right.
constexpr double kFarAway = 1e15;

Vec3f to_float(const Vec3& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

bool far_away(std::span<const Vec3> unit_points) {
  return std::any_of(unit_points.begin(), unit_points.end(), [](const Vec3& p) {
    return !(std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])}) < kFarAway);
  });
}

// A bound in the unit frame, squared, enlarged so that rounding never excludes what lies within max_distance.
float squared_limit(const UnitFrame& frame, double max_distance) {
  const double limit = (1 + 1e-5) * frame.scale * max_distance + 1e-6;
  return static_cast<float>(
      std::min(limit * limit, static_cast<double>(std::numeric_limits<float>::infinity())));
}

}  // namespace

void cpu_search(const Sites::Impl& sites, std::span<const Vec3> points, double max_distance,
                std::span<ClosestPoint> out) {
  const float limit = squared_limit(sites.frame, max_distance);
  thread_local Traversal traversal;
  std::uint32_t seed_face = kNone;
  Packet packet;
  for (std::size_t begin = 0; begin < points.size(); begin += Packet::kSize) {
    const std::size_t count = std::min<std::size_t>(Packet::kSize, points.size() - begin);
    const std::span<const Vec3> queries = points.subspan(begin, count);
    std::array<Vec3, Packet::kSize> unit;
    std::array<Vec3f, Packet::kSize> lanes;
    for (std::size_t i = 0; i < count; ++i) lanes[i] = to_float(unit[i] = sites.frame.to_unit(queries[i]));
    if (far_away({unit.data(), count})) {
      reference_search(sites, queries, max_distance, out.subspan(begin, count));
      continue;
    }
    packet.place({lanes.data(), count});
    if (seed_face == kNone) {
      packet.start(limit, nullptr, kNone);
    } else {
      // The neighbour's closest face, its closest point to a point of this packet: a bound within a packet's
      // size of the truth.
      const ClosestPoint seed = closest_on_face(sites, seed_face, queries[count / 2]);
      const Vec3f point = to_float(sites.frame.to_unit(seed.point));
      packet.start(limit, &point, seed_face);
    }
    traverse(sites.wide, sites.regions, packet, traversal);
    for (std::size_t i = 0; i < count; ++i) {
      ClosestPoint& c = out[begin + i] = {};
      if (packet.face[i] == kNone) continue;
      c = closest_around_face(sites, packet.face[i], queries[i]);
      if (c.distance > max_distance) c = {};
    }
    seed_face = packet.face[count / 2];
  }
}

}  // namespace sdm
