#include "bodies/separate/common_translation.h"

#include <algorithm>
#include <cstdint>

#include "bodies/convex/difference_hull.h"
#include "bodies/separate/free_translations.h"
#include "bodies/separate/moved_pair.h"
#include "bodies/separate/search_steps.h"
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
    // Those that collided last mostly do again.
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
  std::array boxes{pairs[0].o1->box(), pairs[0].o2->box()};
  for (const PosedPair& pair : pairs) {
    extend(boxes[0], pair.o1->box());
    extend(boxes[1], pair.o2->box());
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

}  // namespace

CommonTranslation common_translation(std::span<const PosedPair> pairs, CommonWorkspace& workspace) {
  const auto& [first, second] = boxes_of(pairs);
  Box box = first;
  extend(box, second);
  const double size = diagonal(box);
  MovedPairs moved(pairs, workspace);
  const convex::ConvexExit exit = convex::exit_of_hulls(
      [pairs](const Vec3& u, const std::array<std::uint32_t, 2>&) { return farthest_of_all(pairs, u); },
      normalized(centre(second) - centre(first)), size, workspace.exit);
  const Vec3 out = beyond(moved, -std::max(0.0, exit.upper) * exit.direction, -exit.direction, size);

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
