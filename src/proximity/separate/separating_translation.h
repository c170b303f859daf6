// The shortest translation after which two bodies do not collide.
#pragma once

#include <sdm/proximity_query.h>

#include "proximity/pair/pair_answers.h"
#include "query/shape/posed_body.h"

namespace sdm::separate {

/// As ProximityQuery::separating_translation(). `answers`: of these bodies.
[[nodiscard]] SeparatingTranslation separating_translation(const shape::PosedBody& o1,
                                                           const shape::PosedBody& o2,
                                                           pair::PairAnswers& answers);

}  // namespace sdm::separate
