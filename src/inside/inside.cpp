#include "inside/inside.h"

#include <algorithm>
#include <atomic>

#include "core/geometry/vec.h"
#include "inside/near_faces.h"

namespace sdm::inside {
namespace {

std::uint64_t unique_number() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

// A ball that the surface does not meet: all its points are inside, or all are outside.
struct Ball {
  std::uint64_t shape = 0;
  Vec3 centre{};
  double squared_radius = 0;
  bool inside = false;
};

}  // namespace

InsideTest::InsideTest(const sites::SitesData& sites, SignMethod method) : sites_(sites), method_(method) {
  if (method == SignMethod::exact) sides_.emplace(sites);
  refit();
}

void InsideTest::refit() {
  box_ = bounds(sites_.mesh);
  clearance_ = kClearance / sites_.frame.scale;
  shape_ = unique_number();
  if (sides_) sides_->forget();
  if (method_ == SignMethod::winding) winding_.emplace(sites_);
}

bool InsideTest::inside_solid(const Vec3& query, const ClosestPoint& closest) const {
  const Sides sides = sides_->of_site(closest.type, closest.site);
  switch (sides) {
    case Sides::buried:
      return true;
    case Sides::mixed:
      return closest.distance > 0 && winding(sites_, {}, query) != 0;
    default: {
      const double outward =
          dot(query - closest.point, sites::pseudonormal(sites_.normals, sites_.topology, closest));
      return sides == Sides::boundary ? outward < 0 : outward > 0;
    }
  }
}

bool InsideTest::operator()(const Vec3& query, const ClosestPoint& closest) const {
  switch (method_) {
    case SignMethod::exact:
      return closest.type != SiteType::none && sdm::contains(box_, query) && inside_solid(query, closest);
    case SignMethod::winding:
      return winding_->above_half(query);
    default:
      return false;
  }
}

bool InsideTest::at_boundary(const Vec3& query, const ClosestPoint& closest) const {
  switch (sides_->of_site(closest.type, closest.site)) {
    case Sides::boundary:
    case Sides::reversed:
      return true;
    case Sides::buried:
      return false;
    default: {
      // No face lies between the two; whether the solid goes on behind the closest point remains to be found.
      const Vec3 beyond = closest.point + 0.25 * clearance_ * normalized(closest.point - query);
      return winding(sites_, {}, beyond) == 0;
    }
  }
}

std::uint32_t InsideTest::operator()(std::span<const Vec3> queries,
                                     const sites::ClosestPacket& closest) const {
  std::uint32_t inside = 0;
  if (method_ == SignMethod::none) return inside;
  if (method_ == SignMethod::winding) {
    for (std::size_t i = 0; i < closest.count; ++i)
      inside |= static_cast<std::uint32_t>((*this)(queries[i], closest.get(i, queries[i]))) << i;
    return inside;
  }
  thread_local Ball last;
  for (std::size_t i = 0; i < closest.count; ++i) {
    const Vec3& query = queries[i];
    if (!sdm::contains(box_, query)) continue;
    if (last.shape != shape_ || !(squared_norm(query - last.centre) < last.squared_radius)) {
      if (closest.type[i] == SiteType::none) continue;
      const double radius = std::max(0.0, closest.distance[i] - clearance_);
      last = {shape_, query, radius * radius, inside_solid(query, closest.get(i, query))};
      if (radius == 0) {  // not even the query itself is in the ball
        inside |= static_cast<std::uint32_t>(last.inside) << i;
        continue;
      }
    }
    inside |= static_cast<std::uint32_t>(last.inside) << i;
  }
  return inside;
}

}  // namespace sdm::inside
