#include "closest/facing/facing_search.h"

#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "closest/exact.h"
#include "closest/facing/normal_cones.h"
#include "geometry/rounding.h"
#include "tree/visit.h"

namespace sdm::facing {
namespace {

double cosine_of(double angle) {
  check_angle(angle);
  return std::cos(angle * std::numbers::pi / 180) - kDoubleRounding;
}

/// The angle of a face at one of its vertices.
double angle_at(const Mesh& mesh, std::uint32_t face, std::uint32_t vertex) {
  const Triangle& t = mesh.triangles[face];
  const int corner = t[0] == vertex ? 0 : t[1] == vertex ? 1 : 2;
  const Vec3& at = mesh.positions[vertex];
  const Vec3 a = mesh.positions[t[(corner + 1) % 3]] - at, b = mesh.positions[t[(corner + 2) % 3]] - at;
  return std::atan2(norm(cross(a, b)), dot(a, b));
}

}  // namespace

void check_angle(double angle) {
  if (!(angle > 0 && angle <= 180))
    throw Error("the angle within which faces face the samples must be above 0 and at most 180 degrees");
}

FacingAngle::FacingAngle(double degrees) : right_angle_(degrees == 90), least_cosine_(cosine_of(degrees)) {}

FacingSearch::FacingSearch(const sites::SitesData& sites, double angle)
    : sites_(sites), bounds_(normal_bounds_of(sites)), angle_(angle) {}

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

std::vector<std::uint32_t> FacingSearch::some_allowed(const Vec3& normal, std::size_t most) const {
  const tree::AabbTree& tree =
      bounds_.by_normal.get([this] { return std::make_shared<tree::AabbTree>(normal_tree(sites_)); });
  std::vector<std::uint32_t> found;
  const auto enter = [&](const tree::Subtree& below) {
    return found.size() < most && angle_.allows(largest_cosine(tree.box(below.root), normal));
  };
  const auto leaf = [&](std::uint32_t node) {
    for (const std::uint32_t face : tree.items_of(node))
      if (found.size() < most && allows(normal, face)) found.push_back(face);
  };
  tree::visit(tree, tree::InOrder{enter, leaf});
  return found;
}

std::optional<std::vector<std::uint32_t>> FacingSearch::few_allowed(const Vec3& normal) const {
  constexpr double kFewest = 64;
  const auto few = static_cast<std::size_t>(
      std::max(kFewest, std::sqrt(static_cast<double>(sites_.mesh.triangles.size()))));
  std::vector<std::uint32_t> found = some_allowed(normal, few + 1);
  return found.size() <= few ? std::optional(std::move(found)) : std::nullopt;
}

ClosestPoint FacingSearch::closest_allowed(const Vec3& query, const Vec3& normal, double max_distance) const {
  std::size_t nodes = 0;
  const auto allowed = [&](std::uint32_t face) { return allows(normal, face); };
  const ClosestPoint found = closest::exact_closest(
      sites_, query, max_distance,
      [&](std::uint32_t node) { return ++nodes <= kManyNodes && may_allow(node, normal); }, allowed);
  if (nodes <= kManyNodes) return found;
  if (const auto few = few_allowed(normal)) return closest::exact_closest(sites_, query, max_distance, *few);
  return closest::exact_closest(
      sites_, query, max_distance, [&](std::uint32_t node) { return may_allow(node, normal); }, allowed);
}

Match FacingSearch::match(const Vec3& query, const Vec3& normal, double max_distance,
                          const ClosestPoint& closest) const {
  if (normal == Vec3{}) return {.unmatched = true};
  Match result{.closest = closest};
  Vec3 outward{};
  std::uint32_t face = kNone;
  if (closest.type != SiteType::none) outward = normal_at(closest, normal, face);
  if (closest.type != SiteType::none && face == kNone) {
    result.closest = closest_allowed(query, normal, max_distance);
    if (result.closest.type != SiteType::none) outward = normal_at(result.closest, normal, face);
  }
  result.closest.face = face;
  if (result.closest.type == SiteType::none)
    result.unmatched = some_allowed(normal, 1).empty();
  else
    result.behind = dot(query - result.closest.point, outward) < 0;
  return result;
}

}  // namespace sdm::facing
