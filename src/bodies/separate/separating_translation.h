// The shortest translation after which two bodies do not collide.
#pragma once

#include <sdm/proximity_query.h>

#include "bodies/convex/difference_hull.h"
#include "bodies/pair/pair_answers.h"
#include "bodies/separate/overlap_cover.h"
#include "bodies/shape/posed_body.h"

namespace sdm::separate {

/// Memory that searches reuse; results do not depend on it.
struct TranslationWorkspace {
  convex::ExitWorkspace exit;
  OverlapCover cover;
  pair::PairAnswers moved{0, std::nullopt};
};

/// As ProximityQuery::separating_translation(). `answers`: of these bodies.
[[nodiscard]] SeparatingTranslation separating_translation(const shape::PosedBody& o1,
                                                           const shape::PosedBody& o2,
                                                           pair::PairAnswers& answers,
                                                           TranslationWorkspace& workspace);

}  // namespace sdm::separate
