#include "bodies/separate/overlap_cover.h"
#include "closest/single_point.h"
#include "geometry/vec.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace sdm::separate {
namespace {

// Limits of the search: cubes, searches for a closest point, collision tests and searches for a depth.
constexpr std::size_t kMostCubes = 5000, kMostMeasured = 4000, kMostTests = 100, kMostDepths = 3;
// Pairs of a cube whose balls are measured.
constexpr std::size_t kTried = 3;
// Cubes that are smaller, relative to the length of the best translation, take part in tests.
constexpr double kSmall = 0.26;

double distance_from_origin(const Vec3& centre, double half) {
  Vec3 nearest;
  for (int k = 0; k < 3; ++k) nearest[k] = std::max(0.0, std::abs(centre[k]) - half);
  return norm(nearest);
}

constexpr auto kFarther = [](const auto& a, const auto& b) { return a.least > b.least; };

}  // namespace

double OverlapCover::Cube::half_diagonal() const {
  return std::sqrt(3.0) * half;
}

void OverlapCover::start(const shape::PosedBody& o1, const shape::PosedBody& o2, double error) {
  bodies_ = {&o1, &o2};
  to_frame_ = {inverse(o1.pose().map), inverse(o2.pose().map)};
  error_ = error;
  measured_ = 0;
  pairs_.clear();
  deep_.clear();
  open_.clear();
  // Lists are used in the same order by each search, so that equal searches need no more memory.
  unused_.resize(lists_.size());
  std::iota(unused_.rbegin(), unused_.rend(), 0u);
  std::array<std::size_t, 2> solid{};  // the number of balls; points follow
  for (int body = 0; body < 2; ++body) {
    const mesh::Similarity& pose = bodies_[body]->pose();
    balls_[body].clear();
    const shape::InnerBalls& inner = bodies_[body]->body().inner_balls();
    for (const shape::Ball& ball : inner.balls)
      balls_[body].push_back({pose.map(ball.centre), pose.scale * ball.radius - error_});
    solid[body] = balls_[body].size();
    for (const Vec3& p : inner.surface) balls_[body].push_back({pose.map(p), 0});
  }
  for (std::uint32_t i = 0; i < balls_[0].size(); ++i)
    for (std::uint32_t j = 0; j < (i < solid[0] ? balls_[1].size() : solid[1]); ++j) {
      const shape::Ball &a = balls_[0][i], &b = balls_[1][j];
      pairs_.push_back({b.centre - a.centre, a.radius + b.radius - error_, {i, j}});
    }
}

// The radius of a ball of one body, and the distance of its centre to the surface of the other one.
double OverlapCover::measure(int body, const shape::Ball& ball, const Vec3& translation) {
  const shape::PosedBody& solid = *bodies_[1 - body];
  if (!solid.body().solid()) return -kInfinity;
  const Vec3 p = body == 0 ? ball.centre + translation : ball.centre - translation;
  // Outside the box the distance is at least that to the box.
  if (const double outside = norm(gap(Box{p, p}, solid.box())); outside > ball.radius)
    return ball.radius - outside;
  ++measured_;
  const Vec3 q = to_frame_[1 - body](p);
  const ClosestPoint closest = closest::closest_point(internals(solid.body().sites()), q, kInfinity);
  const double distance = solid.pose().scale * closest.distance;
  return ball.radius + (solid.body().inside()(q, closest) ? distance : -distance) - error_;
}

double OverlapCover::bound_at_origin() {
  open_.assign(1, {.list = take_list()});
  std::vector<std::uint32_t>& all = lists_[open_[0].list].pairs;
  all.resize(pairs_.size());
  std::iota(all.begin(), all.end(), 0u);
  double most = 0;
  for (const BallPair& pair : pairs_) most = std::max(most, pair.radius - norm(pair.centre));
  for (int body = 0; body < 2; ++body)
    for (const shape::Ball& ball : balls_[body]) most = std::max(most, measure(body, ball, {}));
  return most;
}

std::uint32_t OverlapCover::take_list() {
  if (unused_.empty()) {
    const auto next = static_cast<std::uint32_t>(lists_.size());
    lists_.emplace_back();
    unused_.reserve(lists_.capacity());
    unused_.push_back(next);
  }
  const std::uint32_t list = unused_.back();
  unused_.pop_back();
  lists_[list].pairs.clear();
  lists_[list].users = 1;
  return list;
}

void OverlapCover::release(std::uint32_t list) {
  if (--lists_[list].users == 0) unused_.push_back(list);
}

// Whether a pair of balls covers the cube. If not, leaves those that may be the best somewhere in the cube,
// and cover a part of it: v changes by at most half the diagonal.
bool OverlapCover::covered_by_pairs(Cube& cube) {
  const double half_diagonal = cube.half_diagonal();
  double best = -kInfinity;
  values_.clear();
  for (const std::uint32_t i : lists_[cube.list].pairs) {
    const double v = pairs_[i].radius - norm(cube.centre - pairs_[i].centre);
    if (v > half_diagonal) return true;
    best = std::max(best, v);
    if (v > -half_diagonal) values_.push_back({v, i});
  }
  std::erase_if(values_, [&](const Value& value) { return value.v < best - 2 * half_diagonal; });
  release(cube.list);
  cube.list = take_list();
  for (const Value& value : values_) lists_[cube.list].pairs.push_back(value.pair);
  return false;
}

// Whether one of the best pairs covers it with the distances to the surfaces, or a deep point does.
bool OverlapCover::covered_by_measuring(const Cube& cube) {
  for (const DeepPoint& p : deep_)
    if (measure(p.body, p.ball, cube.centre) > cube.half_diagonal()) return true;
  const auto tried = values_.begin() + std::min(values_.size(), kTried);
  std::ranges::partial_sort(values_, tried, std::ranges::greater{}, &Value::v);
  for (auto value = values_.begin(); value != tried; ++value)
    for (int body = 0; body < 2; ++body)
      if (measure(body, balls_[body][pairs_[value->pair].ball[body]], cube.centre) > cube.half_diagonal())
        return true;
  return false;
}

// Adds the deepest point of the bodies after a translation.
void OverlapCover::learn(const Cube& cube, MovedPair& pair) {
  const std::optional<BoundedLength>& depth = pair.depth(cube.centre);
  if (!depth || !depth->witness) return;
  // Which of the two points is inside the other body is not said: both are tried.
  for (int body = 0; body < 2; ++body) {
    const Vec3& p = (*depth->witness)[body];
    add_deep_point(body, body == 0 ? p - cube.centre : p);
  }
}

void OverlapCover::divide(const Cube& cube, double beyond) {
  for (unsigned corner = 0; corner < 8; ++corner) {
    Cube child{.half = 0.5 * cube.half, .list = cube.list};
    for (unsigned k = 0; k < 3; ++k)
      child.centre[k] = cube.centre[k] + ((corner >> k & 1) != 0 ? child.half : -child.half);
    child.least = distance_from_origin(child.centre, child.half);
    if (!(child.least < beyond)) continue;
    ++lists_[cube.list].users;
    open_.push_back(child);
    std::ranges::push_heap(open_, kFarther);
  }
}

double OverlapCover::cover(FreeTranslations& free, MovedPair& pair, double enough) {
  if (open_.empty()) return 0;
  open_.front().half = free.length();
  std::size_t depths = 0;
  const std::size_t tests = pair.tries() + kMostTests;
  for (std::size_t cubes = 0; !open_.empty(); ++cubes) {
    const double bound = open_.front().least;
    if (bound >= enough * free.length() || cubes >= kMostCubes || measured_ >= kMostMeasured) return bound;
    std::ranges::pop_heap(open_, kFarther);
    Cube cube = open_.back();
    open_.pop_back();
    if (covered_by_pairs(cube) || (cubes > 0 && covered_by_measuring(cube))) {
      release(cube.list);
      continue;
    }
    const bool known = std::ranges::any_of(values_, [](const Value& value) { return value.v > 0; });
    if (!known && cube.half < kSmall * free.length() && norm(cube.centre) < enough * free.length() &&
        pair.tries() < tests && !free.try_translation(cube.centre) && depths < kMostDepths) {
      ++depths;
      learn(cube, pair);
    }
    divide(cube, free.length());
    release(cube.list);
  }
  return free.length();
}

}  // namespace sdm::separate
