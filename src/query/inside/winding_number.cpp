#include "query/inside/winding_number.h"

#include <algorithm>
#include <functional>
#include <numbers>
#include <optional>

#include "core/cancellation.h"
#include "geometry/vec.h"
#include "query/inside/solid_angle.h"
#include "tree/fold.h"

namespace sdm::inside {
namespace {

std::array<Vec3, 3> corners(const sites::SitesData& sites, std::uint32_t face) {
  const Triangle& t = sites.mesh.triangles[face];
  const auto& p = sites.mesh.positions;
  const bool inverted = sites.inverted[face];
  return {p[t[0]], p[t[inverted ? 2 : 1]], p[t[inverted ? 1 : 2]]};
}

}  // namespace

WindingNumber::WindingNumber(const sites::SitesData& sites)
    : sites_(sites), dipoles_(sites.tree.nodes.size()) {
  const auto add = [](Dipole& d, const Vec3& centre, const Vec3& moment, double area) {
    d.centre += area * centre;
    d.moment += moment;
    d.area += area;
  };
  // `d` holds the sums over the subtree of a node, `box` is the box of the node.
  const auto finish = [&](Dipole& d, const tree::FloatBox& box) {
    const Vec3 lo{box.lo[0], box.lo[1], box.lo[2]}, hi{box.hi[0], box.hi[1], box.hi[2]};
    const Vec3 middle = sites.frame.origin + (0.5 / sites.frame.scale) * (lo + hi);
    d.centre = d.area > 0 ? (1 / d.area) * d.centre : middle;
    Vec3 farthest;  // from the centre to the box's farthest corner
    for (int k = 0; k < 3; ++k)
      farthest[k] = 0.5 / sites.frame.scale * (hi[k] - lo[k]) + std::abs(d.centre[k] - middle[k]);
    d.radius = norm(farthest);
  };
  Poll due(1024);
  for_each_bottom_up(
      sites.tree,
      [&](std::uint32_t leaf) {
        due();
        for (const std::uint32_t face : sites.tree.items_of(leaf)) {
          const auto [a, b, c] = corners(sites, face);
          const Vec3 moment = 0.5 * cross(b - a, c - a);
          add(dipoles_[leaf], (1.0 / 3) * (a + b + c), moment, norm(moment));
        }
        finish(dipoles_[leaf], sites.tree.box(leaf));
      },
      [&](std::uint32_t node, std::uint32_t left, std::uint32_t right) {
        for (const Dipole& child : {dipoles_[left], dipoles_[right]})
          add(dipoles_[node], child.centre, child.moment, child.area);
        finish(dipoles_[node], sites.tree.box(node));
      });
}

// The solid angle of a subtree is the integral of n·K(x − q) over its faces, K(r) = r / |r|³. The dipole
// takes K at the centre c. By the mean value theorem K(x − q) differs from that by at most |x − c| times the
// largest norm of K's derivative on the way, which is 2 / |r|³; thus the error is at most 2·area·radius /
// (distance − radius)³.
double WindingNumber::operator()(const Vec3& q, double error) const {
  poll();
  constexpr double kSphere = 4 * std::numbers::pi;
  if (sites_.tree.nodes.empty()) return 0;
  const double error_per_area = kSphere * error / dipoles_[0].area;
  const double angle = reduce(
      sites_.tree, 0,
      [&](std::uint32_t node) -> std::optional<double> {
        const Dipole& d = dipoles_[node];
        const Vec3 r = d.centre - q;
        const double distance = norm(r), gap = distance - d.radius;
        if (!(gap > 0 && 2 * d.radius <= error_per_area * gap * gap * gap)) return std::nullopt;
        return dot(d.moment, r) / (distance * distance * distance);
      },
      [&](std::uint32_t leaf) {
        double sum = 0;
        for (const std::uint32_t face : sites_.tree.items_of(leaf)) {
          const auto [a, b, c] = corners(sites_, face);
          sum += solid_angle(a - q, b - q, c - q);
        }
        return sum;
      },
      std::plus<>());
  return angle / kSphere;
}

bool WindingNumber::above_half(const Vec3& q) const {
  for (const double error : {0.2, 0.02, 1e-3, 1e-5})
    if (const double number = (*this)(q, error); std::abs(number - 0.5) > error) return number > 0.5;
  return (*this)(q, 0) > 0.5;
}

}  // namespace sdm::inside
