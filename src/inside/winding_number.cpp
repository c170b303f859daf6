#include "inside/winding_number.h"

#include <algorithm>
#include <numbers>

#include "core/vec.h"
#include "inside/solid_angle.h"

namespace sdm::inside {
namespace {

// A dipole stands for its faces from this many radii on.
constexpr double kFar = 3;

std::array<Vec3, 3> corners(const sites::SitesData& sites, std::uint32_t face) {
  const Triangle& t = sites.mesh.triangles[face];
  const auto& p = sites.mesh.positions;
  const bool inverted = sites.inverted[face];
  return {p[t[0]], p[t[inverted ? 2 : 1]], p[t[inverted ? 1 : 2]]};
}

}  // namespace

WindingNumber::WindingNumber(const sites::SitesData& sites)
    : sites_(sites), dipoles_(sites.tree.nodes.size()) {
  const auto& nodes = sites.tree.nodes;
  for (std::size_t i = nodes.size(); i-- > 0;) {  // children before parents
    Dipole& d = dipoles_[i];
    const auto add = [&d](const Vec3& centre, const Vec3& moment, double area) {
      d.centre += area * centre;
      d.moment += moment;
      d.area += area;
    };
    if (nodes[i].leaf()) {
      for (std::uint32_t k = nodes[i].first; k < nodes[i].first + nodes[i].count; ++k) {
        const auto [a, b, c] = corners(sites, sites.tree.items[k]);
        const Vec3 moment = 0.5 * cross(b - a, c - a);
        add((1.0 / 3) * (a + b + c), moment, norm(moment));
      }
    } else {
      for (const Dipole& child : {dipoles_[i + 1], dipoles_[nodes[i].right]})
        add(child.centre, child.moment, child.area);
    }
    const hierarchy::FloatBox& box = nodes[i].box;
    const Vec3 lo{box.lo[0], box.lo[1], box.lo[2]}, hi{box.hi[0], box.hi[1], box.hi[2]};
    const Vec3 middle = sites.frame.origin + (0.5 / sites.frame.scale) * (lo + hi);
    d.centre = d.area > 0 ? (1 / d.area) * d.centre : middle;
    Vec3 farthest;  // from the centre to the box's farthest corner
    for (int k = 0; k < 3; ++k)
      farthest[k] = 0.5 / sites.frame.scale * (hi[k] - lo[k]) + std::abs(d.centre[k] - middle[k]);
    d.radius = norm(farthest);
  }
}

double WindingNumber::operator()(const Vec3& q) const {
  return at(0, q) / (4 * std::numbers::pi);
}

double WindingNumber::at(std::uint32_t index, const Vec3& q) const {
  const Dipole& d = dipoles_[index];
  const Vec3 r = d.centre - q;
  const double distance = norm(r);
  if (distance > kFar * d.radius) return dot(d.moment, r) / (distance * distance * distance);
  const hierarchy::AabbTree::Node& node = sites_.tree.nodes[index];
  if (!node.leaf()) return at(index + 1, q) + at(node.right, q);
  double sum = 0;
  for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
    const auto [a, b, c] = corners(sites_, sites_.tree.items[k]);
    sum += solid_angle(a - q, b - q, c - q);
  }
  return sum;
}

}  // namespace sdm::inside
