// The shortest translation after which several pairs of bodies do not collide.
#pragma once

#include <sdm/proximity_query.h>

#include <optional>
#include <span>
#include <vector>

#include "bodies/pair/pair_answers.h"
#include "bodies/shape/posed_body.h"

namespace sdm::separate {

/// Two bodies of which O1 is translated, with others.
struct PosedPair {
  const shape::PosedBody *o1 = nullptr, *o2 = nullptr;
  Transform frame{};                 ///< of the whole that O1 is part of, in space
  std::optional<Transform> local{};  ///< the pose of O1 in that frame, if O1 is not the whole
  SeparatingTranslation alone{};     ///< of this pair by itself; 0 if it does not collide
};

/// A translation after which no pair collides, and how far apart the nearest of them are then.
struct CommonTranslation {
  SeparatingTranslation translation{};
  double apart = 0;
};

/// Memory that searches reuse; results do not depend on it.
struct CommonWorkspace {
  convex::ExitWorkspace exit;
  std::vector<shape::PosedBody> moved;
  pair::PairAnswers answers{0, std::nullopt};
};

/// Finds one that is short, of pairs at least one of which collides. The hulls of all O1 and all O2 give one
/// to begin with; those of the pairs, and the directions of a cube, others. The lower bound is the largest
/// one of a pair: a translation that separates all of them separates it.
[[nodiscard]] CommonTranslation common_translation(std::span<const PosedPair> pairs,
                                                   CommonWorkspace& workspace);

}  // namespace sdm::separate
