#include "query/facing/facing_search.h"

#include <sdm/error.h>

#include <cmath>
#include <numbers>

#include "geometry/rounding.h"
#include "geometry/vec.h"
#include "query/closest/reference.h"
#include "tree/visit.h"

namespace sdm::facing {
namespace {

/// The angle of a face at one of its vertices.
double angle_at(const Mesh& mesh, std::uint32_t face, std::uint32_t vertex) {
  const Triangle& t = mesh.triangles[face];
  const int corner = t[0] == vertex ? 0 : t[1] == vertex ? 1 : 2;
  const Vec3& at = mesh.positions[vertex];
  const Vec3 a = mesh.positions[t[(corner + 1) % 3]] - at, b = mesh.positions[t[(corner + 2) % 3]] - at;
  return std::atan2(norm(cross(a, b)), dot(a, b));
}

double cosine_of(double angle) {
  check_angle(angle);
  return std::cos(angle * std::numbers::pi / 180) - kDoubleRounding;
}

}  // namespace

void check_angle(double angle) {
  if (!(angle > 0 && angle <= 180))
    throw Error("the angle within which faces face the samples must be above 0 and at most 180 degrees");
}

FacingSearch::FacingSearch(const sites::SitesData& sites, double angle)
    : sites_(sites), right_angle_(angle == 90), least_cosine_(cosine_of(angle)) {
  cones_ = normal_cones(sites);
}

std::span<const std::uint32_t> FacingSearch::faces_of(const ClosestPoint& closest) const {
  switch (closest.type) {
    case SiteType::vertex:
      return sites_.vertex_faces.of(closest.site);
    case SiteType::edge:
      return sites_.topology.edge_faces(closest.site);
    default:
      return {&closest.site, 1};
  }
}

Vec3 FacingSearch::normal_at(const ClosestPoint& closest, const Vec3& normal, std::uint32_t& face) const {
  Vec3 sum{};
  face = kNone;
  for (const std::uint32_t f : faces_of(closest)) {
    if (!allows(normal, f)) continue;
    if (face == kNone) face = f;
    const double weight = closest.type == SiteType::vertex ? angle_at(sites_.mesh, f, closest.site) : 1;
    sum += weight * sites_.normals.face[f];
  }
  return sum;
}

bool FacingSearch::allows_any(const Vec3& normal) const {
  bool found = false;
  tree::visit(sites_.tree, tree::InOrder{[&](const tree::Subtree& below) {
                                           return !found && may_allow(below.root, normal);
                                         },
                                         [&](std::uint32_t leaf) {
                                           for (const std::uint32_t face : sites_.tree.items_of(leaf))
                                             found = found || allows(normal, face);
                                         }});
  return found;
}

Match FacingSearch::match(const Vec3& query, const Vec3& normal, double max_distance,
                          const ClosestPoint& closest) const {
  if (normal == Vec3{}) return {.unmatched = true};
  Match result{.closest = closest};
  Vec3 outward{};
  std::uint32_t face = kNone;
  if (closest.type != SiteType::none) outward = normal_at(closest, normal, face);
  if (closest.type != SiteType::none && face == kNone) {
    result.closest = closest::reference_closest(
        sites_, query, max_distance, [&](std::uint32_t node) { return may_allow(node, normal); },
        [&](std::uint32_t f) { return allows(normal, f); });
    if (result.closest.type != SiteType::none) outward = normal_at(result.closest, normal, face);
  }
  result.closest.face = face;
  if (result.closest.type == SiteType::none)
    result.unmatched = !allows_any(normal);
  else
    result.behind = dot(query - result.closest.point, outward) < 0;
  return result;
}

}  // namespace sdm::facing
