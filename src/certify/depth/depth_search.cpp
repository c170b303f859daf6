#include "certify/depth/depth_search.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "closest/closest_points.h"
#include "closest/single_point.h"
#include "geometry/rounding.h"
#include "geometry/vec.h"
#include "sites/sites_data.h"

namespace sdm::depth {
namespace {

constexpr double kAnywhere = kInfinity;
// Nodes larger than this, relative to the smaller body, are divided at once: hardly any is excluded as a
// whole.
constexpr double kCoarse = 1.0 / 16;
// The cosine between directions that are nearly the same.
constexpr double kSameDirection = 0.9999;
constexpr int kFirstDirections = 3;
// How many parts of the boundary are found for a triangle before it is divided.
constexpr std::uint32_t kMostCuts = 4;
// If more parts have to be measured, walls may be thin. While fewer than so many parts are open for each that
// has been measured, the search is likely to end before a new one would, and goes on up to kMostEasy, or
// until a depth is known that is enough for all points in the walls.
constexpr std::size_t kEasy = 256, kMostEasy = 1024, kOpenOfMeasured = 6;
// No more parts are measured: the bounds stay as far apart as they are then.
constexpr std::size_t kMostParts = std::size_t{1} << 18;

// Whether the part of the boundary that was found excludes the point for which it was found, even though its
// distance is taken to be linear in the triangle. If not, the triangle is too large for that. `enough` is in
// the frame of the solid.
bool cut(const TrianglePart& triangle, const Value& value, double enough) {
  if (value.bounds.all().empty() || triangle.measured > kMostCuts) return false;
  const CornerValues& d = value.bounds.all()[0].distance;
  const CornerValues& w = triangle.weights;
  return w[0] * d[0] + w[1] * d[1] + w[2] * d[2] <= enough;
}

}  // namespace

Depth DepthSearch::find(const Bodies& bodies, const std::array<mesh::Similarity, 2>& to_other,
                        double precision) {
  bodies_ = bodies;
  precision_ = precision;
  coarse_ = kCoarse * std::min(diagonal(bodies[0]->box()), diagonal(bodies[1]->box()));
  depth_ = {};
  measured_ = 0;
  parts_.start(0, precision);
  for (int body = 0; body < 2; ++body)
    if (bodies[1 - body]->body().solid()) {
      leaving_[body].start(*bodies[body], *bodies[1 - body], to_other[body]);
      find_exits(body);
    }
  budget_ = kEasy;
  search_all();
  const auto is_unfinished = [&] { return parts_.upper() > parts_.enough() && !within_budget(); };
  while (is_unfinished() && budget_ < kMostEasy && parts_.open_count() < kOpenOfMeasured * measured_ &&
         !walls_are_no_deeper()) {
    budget_ *= 2;
    search::branch_and_bound(*this, parts_);
  }
  if (is_unfinished()) {
    budget_ = kMostParts;
    if (look_at_walls()) {
      parts_.start(parts_.lower(), precision);
      search_all();
    } else {
      search::branch_and_bound(*this, parts_);
    }
  }
  depth_.lower = parts_.lower();
  depth_.upper = parts_.upper();
  return depth_;
}

// Searches from the roots of both trees.
void DepthSearch::search_all() {
  for (int body = 0; body < 2; ++body)
    if (bodies_[1 - body]->body().solid()) leaving_[body].divide({.body = body, .what = NodePart{0}}, parts_);
  search::branch_and_bound(*this, parts_);
}

// Whether no point in most of the walls of each solid is deeper than what is enough.
bool DepthSearch::walls_are_no_deeper() const {
  for (int body = 0; body < 2; ++body)
    if (bodies_[1 - body]->body().solid() && !leaving_[body].has_walls(parts_.enough())) return false;
  return true;
}

// Whether the walls of a solid are thin: nodes of any size may then be excluded as a whole.
bool DepthSearch::look_at_walls() {
  bool thin = false;
  for (int body = 0; body < 2; ++body)
    if (bodies_[1 - body]->body().solid()) {
      leaving_[body].look_at_walls(parts_.enough());
      thin |= leaving_[body].thin();
    }
  return thin;
}

// Steps towards a deep point: the point of the body that is farthest from the exit in some direction, and the
// direction from there to the boundary.
void DepthSearch::find_exits(int body) {
  Leaving& leaving = leaving_[body];
  const shape::Body& solid = leaving.solid();
  Vec3 direction = normalized(leaving.to_solid().map(centre(leaving.body().box())) - centre(solid.box()));
  if (direction == Vec3{}) direction = {1, 0, 0};
  std::optional<Vec3> far;
  for (int i = 0; i < kFirstDirections; ++i) {
    leaving.exits().add(direction, far);
    const Vec3 p = leaving.exits().farthest_from_exit();
    const ClosestPoint closest = closest::closest_point(internals(solid.sites()), p, kAnywhere);
    if (!solid.inside()(p, closest)) return;
    const BoundaryDistance b = boundary_distance(solid, p, closest);
    if (b.nearest) leaving.learn(p, *b.nearest);
    if (!improve(body, p, b)) return;
    const Vec3 next = normalized(*b.point - p);
    if (dot(next, direction) > kSameDirection) return;
    direction = next;
    far = b.point;
  }
}

// Whether b is the largest value found so far, with a known point of the boundary.
bool DepthSearch::improve(int body, const Vec3& p, const BoundaryDistance& b) {
  const double scale = leaving_[body].scale();
  if (!(scale * b.lower > parts_.lower())) return false;
  parts_.raise(scale * b.lower);
  depth_.value = scale * b.value;
  depth_.points.reset();
  if (!b.point) return false;
  const Affine& pose = bodies_[1 - body]->pose().map;
  const Vec3 at = pose(p), boundary = pose(*b.point);
  depth_.points = body == 0 ? std::array{at, boundary} : std::array{boundary, at};
  return true;
}

bool DepthSearch::expand(const SurfacePart& part) {
  const Leaving& leaving = leaving_[part.body];
  if (!std::holds_alternative<NodePart>(part.what) || leaving.thin() ||
      leaving.scale() * part.ball.radius <= coarse_)
    return false;
  leaving.divide(part, parts_);
  return true;
}

void DepthSearch::arrange(std::span<SurfacePart> batch) {
  std::ranges::sort(batch, {}, [](const SurfacePart& part) { return std::pair(part.body, part.place); });
}

// Parts of one body follow those of the other.
void DepthSearch::evaluate(std::span<SurfacePart> run, std::vector<Value>& values) const {
  values.assign(run.size(), {});
  if (run.size() == 1) return evaluate_one(run[0], values[0]);
  thread_local std::vector<Vec3> centres;
  for (std::size_t begin = 0; begin < run.size(); begin += centres.size()) {
    const Leaving& leaving = leaving_[run[begin].body];
    centres.clear();
    for (std::size_t i = begin; i < run.size() && run[i].body == run[begin].body; ++i)
      centres.push_back(run[i].ball.centre);
    const std::span<const Vec3> points = centres;
    const auto take = [&](std::size_t first, const sites::ClosestPacket& closest) {
      const std::uint32_t inside = leaving.solid().inside()(points.subspan(first, closest.count), closest);
      for (std::size_t k = 0; k < closest.count; ++k)
        leaving.evaluate(run[begin + first + k], values[begin + first + k], closest.get(k, points[first + k]),
                         (inside >> k & 1) != 0, parts_.enough());
    };
    closest::closest_points(internals(leaving.solid().sites()), points, kAnywhere, std::ref(take));
  }
}

void DepthSearch::evaluate_one(SurfacePart& part, Value& value) const {
  const Leaving& leaving = leaving_[part.body];
  const shape::Body& solid = leaving.solid();
  const Vec3& p = part.ball.centre;
  ClosestPoint closest;
  // If the centre is inside, its bound is one on the search, but for rounding far from the origin.
  if (const auto* triangle = std::get_if<TrianglePart>(&part.what))
    closest = closest::closest_point(internals(solid.sites()), p,
                                     triangle->max_distance + kUnitDistanceRounding * diagonal(solid.box()));
  if (closest.type == SiteType::none)
    closest = closest::closest_point(internals(solid.sites()), p, kAnywhere);
  leaving.evaluate(part, value, closest, solid.inside()(p, closest), parts_.enough());
}

void DepthSearch::learn(std::span<const SurfacePart> run, const std::vector<Value>& values) {
  measured_ += run.size();
  for (std::size_t i = 0; i < run.size(); ++i) {
    const auto& [body, place, ball, upper, exits, what] = run[i];
    const BoundaryDistance& b = values[i].b;
    for (const CornerBound& n : values[i].bounds.all()) leaving_[body].learn(ball.centre, n.boundary);
    if (std::holds_alternative<TrianglePart>(what) && improve(body, ball.centre, b))
      leaving_[body].exits().add(normalized(*b.point - ball.centre), b.point);
  }
}

void DepthSearch::conclude(std::span<SurfacePart> run, const std::vector<Value>& values) {
  const double enough = parts_.enough();
  for (std::size_t i = 0; i < run.size(); ++i) {
    SurfacePart& part = run[i];
    Leaving& leaving = leaving_[part.body];
    auto* triangle = std::get_if<TrianglePart>(&part.what);
    const bool by_cut =
        triangle != nullptr && part.upper > enough && cut(*triangle, values[i], enough / leaving.scale());
    if (triangle != nullptr && part.upper > enough) {
      for (const CornerBound& n : values[i].bounds.all()) {
        triangle->bounds.add(n);
        triangle->stale = true;
      }
      leaving.tighten(part, enough);
    }
    // The distance to the boundary of a solid that intersects itself has bounds that no division tightens.
    const bool finest = triangle != nullptr &&
                        leaving.scale() * part.ball.radius <= std::max(0.125 * precision_, triangle->gap);
    if (part.upper <= enough || finest)
      parts_.settle(part.upper);
    else if (by_cut)
      parts_.put(part);
    else
      leaving.divide(part, parts_);
  }
}

}  // namespace sdm::depth
