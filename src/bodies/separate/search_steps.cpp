#include "bodies/separate/search_steps.h"

#include <algorithm>

#include "bodies/convex/support_search.h"
#include "bodies/shape/extreme_vertex.h"
#include "bodies/solids/posed_core.h"

namespace sdm::separate {

Vec3 farthest(const shape::PosedBody& body, const convex::ConvexMesh* convex, const Vec3& u,
              std::uint32_t& vertex) {
  if (body.body().rounded()) {
    const solids::PosedCore core(body);
    return core.support(u, vertex) + core.radius() * u;
  }
  const auto& rows = body.pose().map.rows;
  const Vec3 local = u[0] * rows[0] + u[1] * rows[1] + u[2] * rows[2];
  if (convex != nullptr) {
    const double scale = body.pose().scale;
    vertex = convex::farthest_vertex(*convex, scale == 1 ? local : (1 / scale) * local, vertex);
    return body.pose().map(convex->points[vertex]);
  }
  return body.pose().map(shape::extreme_vertex(internals(body.body().sites()), normalized(local)).point);
}

Vec3 beyond(TranslatedBodies& bodies, const Vec3& translation, const Vec3& u, double size) {
  for (double gap = kLeastGap; gap < 1; gap *= 10) {
    const Vec3 t = translation + gap * size * u;
    if (!bodies.collide(t)) return t;
  }
  return translation + size * u;
}

SeparatingTranslation bounded_translation(double lower, const Vec3& translation, double size) {
  SeparatingTranslation found;
  found.translation = translation + Vec3{};  // no −0
  found.value = found.upper = norm(translation);
  found.lower = std::clamp(lower, 0.0, found.upper);
  found.certainty = found.upper - found.lower <= kExact * size ? Certainty::exact : Certainty::bounded;
  return found;
}

}  // namespace sdm::separate
