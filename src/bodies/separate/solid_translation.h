// How far a body must be moved to leave another one, if one of them is no mesh, or has a margin.
#pragma once

#include "bodies/pair/pair_answers.h"
#include "bodies/separate/separating_translation.h"

namespace sdm::separate {

/// separating_translation() of such bodies that collide: of convex ones, and of a half-space and anything,
/// the signed distance along its normal. Of another mesh, that of its hull, made shorter as far as that is
/// easy, and the penetration depth as the lower bound.
[[nodiscard]] SeparatingTranslation solid_translation(const shape::PosedBody& o1, const shape::PosedBody& o2,
                                                      pair::PairAnswers& answers,
                                                      TranslationWorkspace& workspace);

}  // namespace sdm::separate
