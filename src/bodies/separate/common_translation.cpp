#include "bodies/separate/common_translation.h"

#include <algorithm>
#include <cstdint>

#include "bodies/convex/difference_hull.h"
#include "bodies/separate/free_translations.h"
#include "bodies/separate/moved_pair.h"
#include "bodies/separate/search_steps.h"
#include "bodies/solids/posed_core.h"
#include "geometry/vec.h"
#include "mesh/similarity.h"

namespace sdm::separate {
namespace {

class MovedPairs final : public TranslatedBodies {
 public:
  MovedPairs(std::span<const PosedPair> pairs, CommonWorkspace& workspace)
      : pairs_(pairs), moved_(workspace.moved), answers_(workspace.answers) {
    moved_.clear();
    for (const PosedPair& pair : pairs) moved_.push_back(*pair.o1);
  }

  [[nodiscard]] bool collide(const Vec3& translation) override {
    ++tries_;
    // The pair that collided last is tried first, as it mostly does again.
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const std::size_t k = (last_ + i) % pairs_.size();
      begin(k, translation);
      if (answers_.colliding()) {
        last_ = k;
        return true;
      }
    }
    return false;
  }

  [[nodiscard]] const BoundedLength& separation(const Vec3& translation) override {
    ++tries_;
    separation_ = {};
    separation_.value = kInfinity;
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      begin(k, translation);
      if (separation_.value > 0 && answers_.surfaces_within(separation_.value) &&
          answers_.separation().value < separation_.value)
        separation_ = answers_.separation();
    }
    return separation_;
  }

 private:
  void begin(std::size_t k, const Vec3& t) {
    const PosedPair& pair = pairs_[k];
    const Transform frame = Transform::translation(t) * pair.frame;
    moved_[k].set_pose(pair.local ? mesh::Similarity::of(frame).transform() * *pair.local : frame);
    answers_.begin(moved_[k], *pair.o2);
  }

  std::span<const PosedPair> pairs_;
  std::vector<shape::PosedBody>& moved_;
  pair::PairAnswers& answers_;
  BoundedLength separation_{};
  std::size_t last_ = 0;
};

// The boxes of all O1 and of all O2.
std::array<Box, 2> boxes_of(std::span<const PosedPair> pairs) {
  std::array<Box, 2> boxes;
  for (const PosedPair& pair : pairs) {
    if (!pair.o1->body().half_space()) extend(boxes[0], pair.o1->box());
    if (!pair.o2->body().half_space()) extend(boxes[1], pair.o2->box());
  }
  return boxes;
}

// The point of the difference of all O1 and all O2 that is farthest along u.
convex::SimplexPoint farthest_of_all(std::span<const PosedPair> pairs, const Vec3& u) {
  std::array<Vec3, 2> points{};
  std::array<double, 2> heights{-kInfinity, -kInfinity};
  const auto compare = [&](int side, const shape::PosedBody& body, const Vec3& direction) {
    std::uint32_t vertex = kNone;
    const Vec3 p = farthest(body, body.body().convex_solid(), direction, vertex);
    if (dot(p, direction) > heights[side]) {
      heights[side] = dot(p, direction);
      points[side] = p;
    }
  };
  for (const PosedPair& pair : pairs) {
    compare(0, *pair.o1, u);
    compare(1, *pair.o2, -u);
  }
  return {{kNone, kNone}, points[0] - points[1]};
}

// The normal of the half-space that bodies leave, away from it for O1; 0 if there is none.
Vec3 normal_of_half_space(std::span<const PosedPair> pairs) {
  for (const PosedPair& pair : pairs) {
    if (pair.o2->body().half_space()) return solids::PosedCore(*pair.o2).normal();
    if (pair.o1->body().half_space()) return -solids::PosedCore(*pair.o1).normal();
  }
  return {};
}

// How far O1 is to be moved along the normal n until a plane across it separates it from O2.
double way_along(const PosedPair& pair, const Vec3& n) {
  const auto height = [](const shape::PosedBody& body, const Vec3& u) {
    const solids::PosedCore core(body);
    std::uint32_t vertex = kNone;
    if (body.body().half_space()) return dot(core.normal(), u) > 0 ? core.offset() : -core.offset();
    return dot(farthest(body, body.body().convex_solid(), u, vertex), u);
  };
  return height(*pair.o2, n) + height(*pair.o1, -n);
}

}  // namespace

CommonTranslation common_translation(std::span<const PosedPair> pairs, CommonWorkspace& workspace) {
  const auto& [first, second] = boxes_of(pairs);
  Box box;
  for (const Box& side : {first, second})
    if (side.lower[0] <= side.upper[0]) extend(box, side);
  const double size = diagonal(box);
  MovedPairs moved(pairs, workspace);
  Vec3 direction = normal_of_half_space(pairs);
  double way = 0;
  if (direction != Vec3{}) {
    for (const PosedPair& pair : pairs) way = std::max(way, way_along(pair, direction));
  } else {
    const convex::ConvexExit exit = convex::exit_of_hulls(
        [pairs](const Vec3& u, const std::array<std::uint32_t, 2>&) { return farthest_of_all(pairs, u); },
        normalized(centre(second) - centre(first)), size, workspace.exit);
    direction = -exit.direction;
    way = std::max(0.0, exit.upper);
  }
  const Vec3 out = beyond(moved, way * direction, direction, size);

  double lower = 0;
  bool solids = false;
  for (const PosedPair& pair : pairs) {
    lower = std::max(lower, pair.alone.lower);
    solids = solids || pair.o1->body().solid() || pair.o2->body().solid();
  }
  FreeTranslations free(moved, out, size, solids);
  const auto is_close = [&] { return lower >= kClose * free.length(); };
  if (!is_close()) free.improve();
  for (const PosedPair& pair : pairs) {
    if (is_close()) break;
    if (pair.alone.value == 0) continue;
    if (pair.alone.value < free.length() && free.try_translation(pair.alone.translation)) continue;
    free.try_direction(normalized(pair.alone.translation), std::max(lower, pair.alone.value));
  }
  if (!is_close())
    for_each_direction([&](const Vec3& u) { free.try_direction(u, std::max(lower, 0.3 * free.length())); });
  return {bounded_translation(lower, free.best(), size), moved.separation(free.best()).value};
}

}  // namespace sdm::separate
