#include "closest/facing/normal_cones.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "geometry/vec.h"
#include "sites/regions.h"
#include "tree/fold.h"

namespace sdm::facing {
namespace {

/// A cone in double precision: half of its opening angle, negative if there is no vector.
struct WideCone {
  Vec3 axis{};
  double half = -1;
};

constexpr double kSphere = std::numbers::pi;

double angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(norm(cross(a, b)), dot(a, b));
}

/// The smallest cone around two.
WideCone join(const WideCone& a, const WideCone& b) {
  if (a.half < 0) return b;
  if (b.half < 0) return a;
  const double apart = angle_between(a.axis, b.axis);
  if (apart + b.half <= a.half) return a;
  if (apart + a.half <= b.half) return b;
  const double half = (apart + a.half + b.half) / 2, sine = std::sin(apart), turn = half - a.half;
  if (half >= kSphere || sine < 1e-6) return {a.axis, std::min(kSphere, apart + a.half + b.half)};
  return {normalized((std::sin(apart - turn) / sine) * a.axis + (std::sin(turn) / sine) * b.axis), half};
}

WideCone cone_of_leaf(const sites::SitesData& sites, std::uint32_t leaf) {
  Vec3 sum{};
  for (const std::uint32_t face : sites.tree.items_of(leaf))
    if (has_normal(sites, face)) sum += sites.normals.face[face];
  WideCone cone{normalized(sum)};
  for (const std::uint32_t face : sites.tree.items_of(leaf)) {
    if (!has_normal(sites, face)) continue;
    if (cone.axis == Vec3{}) return {sites.normals.face[face], kSphere};
    cone.half = std::max(cone.half, angle_between(cone.axis, sites.normals.face[face]));
  }
  return cone;
}

Cone in_single(const WideCone& cone) {
  if (cone.half < 0) return {};
  constexpr double kRounding = 1e-6;
  const double half = std::min(kSphere, cone.half + kRounding);
  Cone result{.cosine = static_cast<float>(std::cos(half)), .sine = static_cast<float>(std::sin(half))};
  for (int k = 0; k < 3; ++k) result.axis[k] = static_cast<float>(cone.axis[k]);
  return result;
}

}  // namespace

std::vector<Cone> normal_cones(const sites::SitesData& sites) {
  std::vector<WideCone> wide(sites.tree.nodes.size());
  tree::for_each_bottom_up(
      sites.tree, [&](std::uint32_t leaf) { wide[leaf] = cone_of_leaf(sites, leaf); },
      [&](std::uint32_t node, std::uint32_t left, std::uint32_t right) {
        wide[node] = join(wide[left], wide[right]);
      });
  std::vector<Cone> cones(wide.size());
  std::ranges::transform(wide, cones.begin(), in_single);
  return cones;
}

const NormalBounds& normal_bounds_of(const sites::SitesData& sites) {
  return sites.normal_bounds.get([&] {
    auto bounds = std::make_shared<NormalBounds>();
    bounds->cones = normal_cones(sites);
    return bounds;
  });
}

tree::AabbTree normal_tree(const sites::SitesData& sites) {
  std::vector<tree::FloatBox> boxes(sites.mesh.triangles.size());
  std::vector<std::uint32_t> faces;
  for (const std::uint32_t face : sites.tree.items) {
    if (!has_normal(sites, face)) continue;
    Box box;
    extend(box, sites.normals.face[face]);
    boxes[face] = tree::FloatBox::around(box);
    faces.push_back(face);
  }
  return tree::build_aabb_tree(boxes, std::move(faces), sites::FaceBounds::kWidth);
}

}  // namespace sdm::facing
