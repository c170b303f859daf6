#include "bodies/contacts/surface_point.h"

#include "closest/single_point.h"
#include "geometry/rounding.h"
#include "sites/closest_on_face.h"

namespace sdm::contacts {

SurfacePoint measure(const shape::Body& body, const Vec3& at, double likely_distance) {
  const sites::SitesData& sites = internals(body.sites());
  const double limit =
      (1 + kUnitDistanceRounding) * likely_distance + kUnitDistanceRounding / sites.frame.scale;
  ClosestPoint closest = closest::closest_point(sites, at, limit);
  if (closest.type == SiteType::none) closest = closest::closest_point(sites, at, kInfinity);
  return {.at = at,
          .distance = body.inside()(at, closest) ? -closest.distance : closest.distance,
          .vector = closest.point - at,
          .closest = closest,
          .face = sites.face_of(closest.type, closest.site)};
}

SurfacePoint measure_near(const shape::Body& body, const Vec3& at, std::uint32_t face) {
  return measure(
      body, at,
      face == kNone ? kInfinity : sites::closest_on_face(internals(body.sites()), face, at).distance);
}

bool at_boundary(const shape::Body& body, const SurfacePoint& point) {
  return point.distance >= 0 || body.inside().at_boundary(point.at, point.closest);
}

}  // namespace sdm::contacts
