#include "inside/winding_number.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/cancellation.h"
#include "geometry/vec.h"
#include "inside/open_sides.h"
#include "inside/solid.h"

namespace sdm::inside {
namespace {

constexpr double kSphere = 4 * std::numbers::pi;
constexpr double kNoThreshold = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint32_t kLeafFaces = 4;

bool certain(const SolidAngle& angle, double limit) {
  return std::abs(angle.value - limit) > angle.error;
}

}  // namespace

WindingNumber::WindingNumber(const sites::SitesData& sites) : sites_(sites) {
  if (auto closing = inside::closing_faces(sites, sites.tree.items.size() / 2))
    build_closing(std::move(*closing));
  if (!closing_.angles) (void)mesh_angles();
}

void WindingNumber::build_closing(std::vector<Triangle> triangles) {
  closing_.triangles = std::move(triangles);
  std::vector<tree::FloatBox> boxes;
  boxes.reserve(closing_.triangles.size());
  for (const Triangle& t : closing_.triangles) {
    Box box;
    for (const std::uint32_t v : t) extend(box, sites_.frame.to_unit(sites_.mesh.positions[v]));
    boxes.push_back(tree::FloatBox::around(box));
  }
  std::vector<std::uint32_t> all(boxes.size());
  std::iota(all.begin(), all.end(), 0u);
  closing_.tree = tree::build_aabb_tree(boxes, std::move(all), kLeafFaces);
  closing_.wide = tree::collapse(closing_.tree);
  closing_.angles.emplace(closing_faces(), closing_.wide);
  sides_.emplace(sites_, closing_faces());
}

OrientedFaces WindingNumber::closing_faces() const {
  return {{sites_.mesh.positions, closing_.triangles, sites_.frame, closing_.tree}, {}};
}

const SolidAngles& WindingNumber::mesh_angles() const {
  return mesh_angles_.get(
      [this] { return std::make_shared<SolidAngles>(oriented_faces(sites_), sites_.wide); });
}

std::optional<int> WindingNumber::closed(const Vec3& q) const {
  if (!closing_.angles) return {};
  constexpr int kMostSegments = 4;
  const OrientedFaces closing = closing_faces();
  return winding_by_segments(sites_.face_tree(), {}, q, kMostSegments, [&](const Vec3& end) {
    const std::optional<int> through_mesh = crossings(sites_, rays::Segment{q, end});
    if (!through_mesh || closing.faces.tree.nodes.empty()) return through_mesh;
    const std::optional<int> through_closing = crossings(closing, {}, q, end);
    return through_closing ? std::optional(*through_mesh + *through_closing) : std::nullopt;
  });
}

double WindingNumber::operator()(const Vec3& q, double error) const {
  if (sites_.tree.nodes.empty()) return 0;
  poll();
  if (const std::optional<int> number = closed(q)) {
    const SolidAngle angle = closing_.angles->at(q, kNoThreshold, kSphere * error).angle;
    // Near an edge of a closing face, the rounding of its angle may be large.
    if (angle.error <= std::max(kSphere * error, 1e-10)) return *number - angle.value / kSphere;
  }
  return mesh_angles().at(q, kNoThreshold, kSphere * error).angle.value / kSphere;
}

// The mesh has w = n − s/4π, with s the solid angle of the closing faces: w > 1/2 where s < 4π(n − 1/2).
WindingNumber::Side WindingNumber::above_half(const Vec3& q, std::optional<int> closed) const {
  if (closed) {
    const double limit = kSphere * (*closed - 0.5);
    const SolidAngles::Sum sum = closing_.angles->at(q, limit, 0);
    if (certain(sum.angle, limit)) return {sum.angle.value < limit, sum.safe_radius};
  }
  const double limit = 0.5 * kSphere;
  const SolidAngles::Sum sum = mesh_angles().at(q, limit, 0);
  return {sum.angle.value > limit, certain(sum.angle, limit) ? sum.safe_radius : 0};
}

WindingNumber::Side WindingNumber::above_half(const Vec3& q) const {
  if (sites_.tree.nodes.empty()) return {};
  poll();
  return above_half(q, closed(q));
}

std::optional<int> WindingNumber::closed(const Vec3& q, const ClosestPoint& closest, bool few) const {
  const auto direct = [this](const Vec3& point) { return closed(point); };
  if (sides_ && norm(tree::gap(sites_.tree.box(0), sites_.frame.to_unit(q))) == 0)
    if (const std::optional<int> number = (*sides_)(q, closest, few, direct)) return number;
  return direct(q);
}

std::optional<WindingNumber::Side> WindingNumber::coarse_side(const Vec3& q, std::optional<int> closed,
                                                              double clear) const {
  const bool by_closing = closing_.angles.has_value();
  if (!sums_many_faces() || (by_closing && !closed)) return {};
  const SolidAngles& angles = by_closing ? *closing_.angles : mesh_angles();
  const double limit = kSphere * (by_closing ? *closed - 0.5 : 0.5);
  double safe_radius = clear;
  PacketSides side = clear > 0 ? side_of_ball(angles, q, clear, limit) : PacketSides{};
  if (side.known == 0) {
    side = sides_of_packet(angles, {&q, 1}, {&limit, 1});
    safe_radius = 0;
  }
  if (side.known == 0) return {};
  return Side{(side.above != 0) != by_closing, safe_radius};
}

WindingNumber::Side WindingNumber::above_half(const Vec3& q, const ClosestPoint& closest, bool few,
                                              double clear) const {
  if (sites_.tree.nodes.empty()) return {};
  poll();
  const std::optional<int> number = closed(q, closest, few);
  if (const std::optional<Side> side = coarse_side(q, number, clear)) return *side;
  return above_half(q, number);
}

PacketSides WindingNumber::above_half(std::span<const Vec3> points, std::span<const ClosestPoint> closest,
                                      bool few) const {
  if (sites_.tree.nodes.empty()) return {};
  std::array<double, kPacket> limits{};
  const auto used = std::span(limits).first(points.size());
  if (!closing_.angles) {
    std::ranges::fill(used, 0.5 * kSphere);
    return sides_of_packet(mesh_angles(), points, used);
  }
  for (std::size_t i = 0; i < used.size(); ++i) {
    const std::optional<int> number = closed(points[i], closest[i], few);
    used[i] = number ? kSphere * (*number - 0.5) : kNoThreshold;
  }
  const PacketSides sides = sides_of_packet(*closing_.angles, points, used);
  return {sides.known, sides.known & ~sides.above};
}

}  // namespace sdm::inside
