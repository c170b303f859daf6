#include "bodies/separate/separating_translation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "bodies/convex/difference_hull.h"
#include "bodies/separate/free_translations.h"
#include "bodies/separate/moved_pair.h"
#include "bodies/separate/overlap_cover.h"
#include "bodies/separate/search_steps.h"
#include "bodies/shape/convexity.h"
#include "bodies/solids/solid_pair.h"
#include "geometry/vec.h"

namespace sdm::separate {
namespace {

constexpr double kEnough = 0.85;  // ratio of bounds at which the search for a cover ends
// Bodies that only touch: how far they are moved at most, of the size, and steps to the direction.
constexpr double kMostGap = 1e-3;
constexpr int kTurns = 64;
// The rounding error of two points in space and of their difference, relative to the largest coordinate.
constexpr double kSpaceRounding = 16 * std::numeric_limits<double>::epsilon();

class TranslationSearch {
 public:
  TranslationSearch(const shape::PosedBody& o1, const shape::PosedBody& o2, pair::PairAnswers& answers,
                    TranslationWorkspace& workspace)
      : o1_(o1),
        o2_(o2),
        convex_{o1.body().convex_solid(), o2.body().convex_solid()},
        answers_(answers),
        workspace_(workspace),
        pair_(o1, o2, workspace.moved) {
    Box box = o1.box();
    extend(box, o2.box());
    size_ = diagonal(box);
    for (int k = 0; k < 3; ++k)
      rounding_ = std::max(
          {rounding_, kSpaceRounding * std::abs(box.lower[k]), kSpaceRounding * std::abs(box.upper[k])});
  }

  SeparatingTranslation find() {
    const convex::ConvexExit exit = convex::exit_of_hulls(
        [this](const Vec3& u, const std::array<std::uint32_t, 2>& near) {
          convex::SimplexPoint found{near, {}};
          found.w = farthest(o1_, convex_[0], u, found.vertices[0]) -
                    farthest(o2_, convex_[1], -u, found.vertices[1]);
          return found;
        },
        normalized(o2_.ball().centre - o1_.ball().centre), size_, workspace_.exit);
    pair_.set_hints({.closest_vertices = closest_vertices(exit)});
    const Vec3 out = beyond(pair_, -std::max(0.0, exit.upper) * exit.direction, -exit.direction, size_);
    // A body that falls short of its hull a little contains the hull scaled about a point.
    const double short1 = convex_[0] ? 0 : o1_.body().convexity_deficit(),
                 short2 = convex_[1] ? 0 : o2_.body().convexity_deficit();
    if (std::max(short1, short2) <= shape::kNearlyConvex)
      return result(exit.lower - short1 * diagonal(o1_.box()) - short2 * diagonal(o2_.box()), out);
    double lower = 0;
    const Vec3 translation = search(out, lower);
    return result(lower, translation);
  }

 private:
  // The vertices between which convex solids are closest after the exit.
  [[nodiscard]] convex::Simplex closest_vertices(const convex::ConvexExit& exit) const {
    if (!convex_[0] || !convex_[1]) return {};
    convex::Simplex simplex = exit.touching;
    const auto& rows = o1_.pose().map.rows;
    const Vec3& u = exit.direction;
    simplex.away = -normalized(u[0] * rows[0] + u[1] * rows[1] + u[2] * rows[2]);
    return simplex;
  }
  SeparatingTranslation result(double lower, const Vec3& translation) const {
    return bounded_translation(lower - rounding_, translation, size_);
  }

  Vec3 search(const Vec3& out, double& lower) {
    FreeTranslations free(pair_, out, size_, o1_.body().solid() || o2_.body().solid());
    free.improve();
    OverlapCover& cover = workspace_.cover;
    cover.start(o1_, o2_, kExact * size_);
    lower = use_depth(free, cover);
    if (lower < kClose * free.length()) lower = std::max(lower, cover.bound_at_origin());
    if (lower < kClose * free.length())
      for_each_direction([&](const Vec3& u) { free.try_direction(u, std::max(lower, 0.3 * free.length())); });
    if (lower < kClose * free.length()) lower = std::max(lower, cover.cover(free, pair_, kEnough));
    return free.best();
  }

  // The deepest point is still in the other body after all translations that are shorter than its depth; the
  // way out from there is tried for the bodies.
  double use_depth(FreeTranslations& free, OverlapCover& cover) {
    const std::optional<BoundedLength>& depth = answers_.penetration_depth();
    if (!depth) return 0;
    if (depth->witness) {
      const auto& [p1, p2] = *depth->witness;
      const Vec3 out = p2 - p1;
      for (int body = 0; body < 2; ++body)
        if ((body == 0 ? o2_ : o1_).body().solid()) cover.add_deep_point(body, (*depth->witness)[body]);
      if (out != Vec3{})
        for (const double sign : {1.0, -1.0}) free.try_direction(sign * normalized(out), depth->lower);
    }
    if (depth->lower == 0 && free.length() > kExact * size_) leave_touch(free);
    return depth->lower;
  }

  // Bodies that only touch have no deep point. They leave each other along a direction that the normals of
  // all contacts allow: turned towards that which allows it least, until none forbids it.
  void leave_touch(FreeTranslations& free) {
    const std::span<const Contact> contacts = pair_.contacts({});
    if (contacts.empty()) return;
    Vec3 u{};
    for (const Contact& c : contacts) u += c.normal;
    for (int turn = 0; turn < kTurns; ++turn)
      u += std::ranges::min_element(contacts, {}, [&](const Contact& c) { return dot(c.normal, u); })->normal;
    if (u == Vec3{}) return;
    u = normalized(u);
    for (double gap = kLeastGap; gap < kMostGap; gap *= 10)
      if (free.try_translation(gap * size_ * u)) return;
  }

  const shape::PosedBody &o1_, &o2_;
  std::array<const convex::ConvexMesh*, 2> convex_;  // null for others
  pair::PairAnswers& answers_;
  TranslationWorkspace& workspace_;
  MovedPair pair_;
  double size_ = 0, rounding_ = 0;
};

// separating_translation() of such bodies that collide: of convex ones, and of a half-space and anything,
// the signed distance along its normal. Of another mesh, that of its hull, made shorter as far as that is
// easy, and the penetration depth as the lower bound.
SeparatingTranslation solid_translation(const shape::PosedBody& o1, const shape::PosedBody& o2,
                                        pair::PairAnswers& answers, TranslationWorkspace& workspace) {
  const solids::Relation& relation = answers.relation();
  const double size = answers.size();
  MovedPair pair(o1, o2, workspace.moved);
  if (relation.signed_distance) {
    const Vec3 out = beyond(pair, -relation.gap * relation.normal, relation.normal, size);
    return bounded_translation(-relation.gap - relation.error, out, size);
  }
  const solids::PosedCore core1(o1), core2(o2);
  const solids::CoreDistance hulls = solids::core_distance(core1, core2, size, workspace.exit);
  const double way = std::max(0.0, core1.radius() + core2.radius() - hulls.distance);
  const Vec3 out = beyond(pair, way * hulls.normal, hulls.normal, size);
  const double lower = answers.penetration_depth() ? answers.penetration_depth()->lower : 0;
  FreeTranslations free(pair, out, size, true);
  free.improve();
  if (relation.normal != Vec3{}) free.try_direction(relation.normal, lower);
  if (lower < kClose * free.length())
    for_each_direction([&](const Vec3& u) { free.try_direction(u, std::max(lower, 0.3 * free.length())); });
  return bounded_translation(lower, free.best(), size);
}

}  // namespace

SeparatingTranslation separating_translation(const shape::PosedBody& o1, const shape::PosedBody& o2,
                                             pair::PairAnswers& answers, TranslationWorkspace& workspace) {
  if (!answers.colliding()) return {{.certainty = Certainty::exact}};
  if (solids::are_solid_pair(o1, o2)) return solid_translation(o1, o2, answers, workspace);
  return TranslationSearch(o1, o2, answers, workspace).find();
}

}  // namespace sdm::separate
