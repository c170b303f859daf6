#include "certify/hausdorff/side.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "geometry/rounding.h"
#include "geometry/triangle_pair.h"
#include "geometry/vec.h"
#include "inside/solid.h"
#include "tree/visit.h"

namespace sdm::hausdorff {

namespace {

// How far a part may be on the wrong side of a plane that keeps it out of B, in precisions.
constexpr double kSlack = 1.0 / 16;

}  // namespace

bool SolidSide::has(const Vec3& p) const {
  return inside::contains(solid_, p) == inside_;
}

// The way from the point to one on this side leads through B.
double SolidSide::bound(const Corners& triangle, const Known& known) const {
  if (is_one_sided(triangle)) return 0;
  const double slack = kSlack * known.precision;
  if (known.distance > known.precision && only_touches(triangle, slack))
    return std::min(known.upper, 2 * slack);
  return std::clamp((1 + kFewRoundings) * known.reach - known.distance, 0.0, known.upper);
}

bool SolidSide::is_one_sided(const Corners& triangle) const {
  // Mapping corners into the frame rounds.
  Box box;
  for (const Vec3& corner : triangle) {
    Vec3 unit = solid_.frame.to_unit(corner), rounding;
    for (int k = 0; k < 3; ++k) rounding[k] = kFewRoundings * (1 + std::abs(unit[k]));
    extend(box, unit - rounding), extend(box, unit + rounding);
  }
  const tree::FloatBox around = tree::FloatBox::around(box);
  bool apart = true;
  const auto bound = [&](const tree::FloatBox& other) { return norm(tree::gap(around, other)); };
  const auto enter = [&](double distance) { return apart && distance == 0; };
  const auto leaf = [&](std::uint32_t node) {
    for (const std::uint32_t face : solid_.tree.items_of(node))
      if (apart && triangles_intersect(triangle, corners_of(solid_.mesh, face))) apart = false;
  };
  tree::visit(solid_.tree, tree::NearestFirst{bound, enter, leaf});
  return apart;
}

// Where the triangle T meets the surface of B, all faces there are on one side of the plane and T on the
// other. Close to such a place, what is strictly above the plane meets no face and so is all inside of B or
// all outside; the points of T that are not on B are as these are, as T is connected.
bool SolidSide::only_touches(const Corners& triangle, double slack) const {
  constexpr std::size_t kMost = 64;
  constexpr double kFlattest =
      1.0 / 16;  // height of a face, in sizes of the triangle, for its plane to be exact
  Box box;
  double size = 0;
  for (int k = 0; k < 3; ++k) {
    extend(box, solid_.frame.to_unit(triangle[k]));
    size = std::max(size, norm(triangle[k < 2 ? k + 1 : 0] - triangle[k]));
  }
  const double reach = 4 * slack;
  const tree::FloatBox around = tree::FloatBox::around(box);
  std::vector<Corners> faces;
  const auto bound = [&](const tree::FloatBox& other) { return norm(tree::gap(around, other)); };
  const auto enter = [&](double distance) {
    return faces.size() <= kMost && distance <= reach * solid_.frame.scale + 2 * kFewRoundings;
  };
  const auto leaf = [&](std::uint32_t node) {
    for (const std::uint32_t face : solid_.tree.items_of(node)) {
      const Corners corners = corners_of(solid_.mesh, face);
      if (closest_or_common(triangle, corners).squared <= reach * reach) faces.push_back(corners);
    }
  };
  tree::visit(solid_.tree, tree::NearestFirst{bound, enter, leaf});
  if (faces.size() > kMost) return false;
  const auto separates = [&](const Corners& plane) {
    const Vec3 normal = cross(plane[1] - plane[0], plane[2] - plane[0]);
    const double area = norm(normal),
                 longest = std::max(
                     {norm(plane[1] - plane[0]), norm(plane[2] - plane[1]), norm(plane[0] - plane[2])});
    if (!(area >= kFlattest * longest * std::min(size, longest))) return false;
    const auto height = [&](const Vec3& p) { return dot(normal, p - plane[0]) / area; };
    double least = std::numeric_limits<double>::infinity(), most = -least, lowest = least, highest = most;
    for (const Vec3& p : triangle) least = std::min(least, height(p)), most = std::max(most, height(p));
    for (const Corners& face : faces)
      for (const Vec3& p : face) lowest = std::min(lowest, height(p)), highest = std::max(highest, height(p));
    return (least >= -slack && highest <= slack) || (most <= slack && lowest >= -slack);
  };
  return separates(triangle) || std::ranges::any_of(faces, separates);
}

}  // namespace sdm::hausdorff
