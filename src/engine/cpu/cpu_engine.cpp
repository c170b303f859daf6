// The CPU engine: groups of points descend through lists of sites, in the unit frame of O2 and single
// precision; then the winners in double.
#include <algorithm>
#include <cmath>
#include <memory>

#include "core/vec.h"
#include "engine/cpu/descent.h"
#include "engine/cpu/finish.h"
#include "engine/engine.h"

namespace sdm {
namespace {

// Beyond this many sizes of O2 squares come near the end of single precision. The reference engine is slow
// there, since no box is nearer than another, but right.
constexpr double kFarAway = 1e15;

bool far_away(const Vec3& unit_point) {
  return !(std::max({std::abs(unit_point[0]), std::abs(unit_point[1]), std::abs(unit_point[2])}) < kFarAway);
}

Vec3f to_float(const Vec3& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

// A bound in the unit frame, enlarged so that rounding never excludes what lies within max_distance.
float unit_limit(const UnitFrame& frame, double max_distance) {
  return static_cast<float>(std::min((1 + 1e-5) * frame.scale * max_distance + 1e-6, 1e18));
}

}  // namespace

void cpu_search(const Sites::Impl& sites, std::span<const Vec3> points, double max_distance,
                std::span<ClosestPoint> out) {
  thread_local const auto descent = std::make_unique<Descent>();
  const float limit = unit_limit(sites.frame, max_distance);
  std::vector<Vec3f> unit;
  for (std::size_t begin = 0; begin < points.size(); begin += unit.size()) {
    const std::span<const Vec3> rest =
        points.subspan(begin, std::min(PointGroup::kMostPoints, points.size() - begin));
    unit.clear();
    for (const Vec3& p : rest) {
      const Vec3 q = sites.frame.to_unit(p);
      if (far_away(q)) break;
      unit.push_back(to_float(q));
    }
    if (unit.empty()) {
      reference_search(sites, rest.first(1), max_distance, out.subspan(begin, 1));
      unit.resize(1);
      continue;
    }
    descent->points.place(unit);
    find_winners(sites.wide, sites.regions, limit, *descent);
    finish(sites, {descent->winners, unit.size()}, rest.first(unit.size()), max_distance,
           out.subspan(begin, unit.size()));
  }
}

}  // namespace sdm
