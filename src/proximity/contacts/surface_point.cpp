#include "proximity/contacts/surface_point.h"

#include <functional>

#include "core/geometry/vec.h"
#include "engine/cpu/cpu_engine.h"

namespace sdm::contacts {

SurfacePoint measure(const shape::Body& body, const Vec3& at, double reach) {
  constexpr double kRounding = 1e-9;  // of distances, in units of the frame
  const sites::SitesData& sites = internals(body.sites());
  SurfacePoint point{.at = at};
  const auto take = [&](std::size_t, const sites::ClosestPacket& found) {
    if (found.type[0] == SiteType::none) return;
    const bool inside = body.inside()({&at, 1}, found) != 0;
    point.closest = found.get(0, at);
    point.vector = {found.vector[0][0], found.vector[1][0], found.vector[2][0]};
    point.distance = inside ? -found.distance[0] : found.distance[0];
    point.face = sites.face_of(found.type[0], found.site[0]);
  };
  const double limit = (1 + kRounding) * reach + kRounding / sites.frame.scale;
  cpu::cpu_search(sites, {&at, 1}, limit, std::ref(take));
  if (point.face == kNone)
    cpu::cpu_search(sites, {&at, 1}, std::numeric_limits<double>::infinity(), std::ref(take));
  return point;
}

bool at_boundary(const shape::Body& body, const SurfacePoint& point) {
  return point.distance >= 0 || body.inside().at_boundary(point.at, point.closest);
}

}  // namespace sdm::contacts
