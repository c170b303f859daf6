#include "query/inside/inside.h"

#include <algorithm>
#include <array>
#include <atomic>

#include "geometry/vec.h"
#include "query/inside/near_faces.h"

namespace sdm::inside {
namespace {

std::uint64_t unique_number() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

// Balls that the surface does not meet: all points of one are inside, or all are outside, and so are those of
// balls that overlap.
class Balls {
 public:
  // Whether a ball of this shape is inside, if it overlaps a known one.
  [[nodiscard]] std::optional<bool> find(std::uint64_t shape, const Vec3& centre, double radius) const {
    if (shape != shape_) return {};
    for (const Ball& ball : balls_) {
      const double reach = radius + ball.radius;
      if (squared_norm(centre - ball.centre) < reach * reach && ball.radius > 0) return ball.inside;
    }
    return {};
  }
  void add(std::uint64_t shape, const Vec3& centre, double radius, bool inside) {
    if (shape != shape_) balls_ = {}, shape_ = shape;
    next_ = (next_ + 1) % balls_.size();
    balls_[next_] = {centre, radius, inside};
  }

 private:
  struct Ball {
    Vec3 centre{};
    double radius = 0;
    bool inside = false;
  };
  std::uint64_t shape_ = 0;
  std::size_t next_ = 0;
  std::array<Ball, 8> balls_{};
};
thread_local Balls balls;

}  // namespace

InsideTest::InsideTest(const sites::SitesData& sites, SignMethod method, double error)
    : sites_(sites), method_(method), error_(error) {
  if (method == SignMethod::exact) sides_.emplace(sites);
  if (method == SignMethod::side) boundary_ = {sites.topology, sites.mesh.positions.size()};
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

bool InsideTest::behind(const Vec3& query, const ClosestPoint& closest) const {
  if (closest.type == SiteType::none || boundary_.contains(closest.type, closest.site)) return false;
  return dot(query - closest.point, sites::pseudonormal(sites_.normals, sites_.topology, closest)) < 0;
}

// As inside_solid(), but most queries are in a ball that is known.
bool InsideTest::inside_ball(const Vec3& query, const ClosestPoint& closest) const {
  const double radius = closest.distance - std::max(clearance_, error_);
  if (!(radius > 0)) return inside_solid(query, closest);
  std::optional<bool> inside = balls.find(shape_, query, radius);
  if (!inside) {
    inside = inside_solid(query, closest);
    balls.add(shape_, query, radius, *inside);
  }
  return *inside;
}

bool InsideTest::operator()(const Vec3& query, const ClosestPoint& closest) const {
  switch (method_) {
    case SignMethod::exact:
      return closest.type != SiteType::none && sdm::contains(box_, query) && inside_ball(query, closest);
    case SignMethod::winding:
      return winding_->above_half(query);
    case SignMethod::side:
      return behind(query, closest);
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
  if (is_estimate(method_)) {
    for (std::size_t i = 0; i < closest.count; ++i)
      inside |= static_cast<std::uint32_t>((*this)(queries[i], closest.get(i, queries[i]))) << i;
    return inside;
  }
  for (std::size_t i = 0; i < closest.count; ++i) {
    const Vec3& query = queries[i];
    if (!sdm::contains(box_, query)) continue;
    if (closest.type[i] == SiteType::none) continue;
    const double radius = closest.distance[i] - std::max(clearance_, error_);
    std::optional<bool> is_inside;
    if (radius > 0) is_inside = balls.find(shape_, query, radius);
    if (!is_inside) {
      is_inside = inside_solid(query, closest.get(i, query));
      if (radius > 0) balls.add(shape_, query, radius, *is_inside);
    }
    inside |= static_cast<std::uint32_t>(*is_inside) << i;
  }
  return inside;
}

}  // namespace sdm::inside
