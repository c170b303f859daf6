#include "bodies/separate/solid_translation.h"

#include <algorithm>

#include "bodies/separate/free_translations.h"
#include "bodies/separate/moved_pair.h"
#include "bodies/separate/search_steps.h"
#include "bodies/solids/solid_pair.h"
#include "geometry/vec.h"

namespace sdm::separate {

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

}  // namespace sdm::separate
