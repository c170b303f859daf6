#include "mesh/crossings/ray_parity.h"

#include <algorithm>
#include <array>

#include "mesh/topology.h"

namespace sdm::inside {
namespace {

// Rays run along (1, kSlopeY, kSlopeZ): a direction that is unlikely to be parallel to a modelled edge or
// face.
constexpr double kSlopeY = 0.0137035999, kSlopeZ = 0.0072973525;

// A point as seen along the ray from `origin`: its distance along X, and its offset from the ray in y and z.
struct Seen {
  double along;
  Vec2 beside;
};
Seen seen(const Vec3& p, const Vec3& origin) {
  const Vec3 r = p - origin;
  return {r[0], {r[1] - kSlopeY * r[0], r[2] - kSlopeZ * r[0]}};
}

// The sign gives the side of the ray on which an edge passes: that of twice the area spanned by its ends and
// the ray or, where the area is 0, that of its value after the ray is moved by ε in y and by ε² in z, for
// infinitesimal ε. No vertex lies on the moved ray.
double side_of_ray(const Vec2& from, const Vec2& to, double area) {
  if (area != 0) return area;
  return from[1] != to[1] ? from[1] - to[1] : to[0] - from[0];
}

}  // namespace

bool ray_meets(const tree::FloatBox& box, const Vec3& origin) {
  // The part of the ray at 0 ≤ x ≤ hi: the slopes are positive, so that y and z grow with x.
  const double end = box.upper[0] - origin[0];
  if (end < 0) return false;
  const double begin = std::max(0.0, box.lower[0] - origin[0]);
  return origin[1] + kSlopeY * begin <= box.upper[1] && origin[1] + kSlopeY * end >= box.lower[1] &&
         origin[2] + kSlopeZ * begin <= box.upper[2] && origin[2] + kSlopeZ * end >= box.lower[2];
}

bool ray_meets(const Triangle& t, std::span<const Vec3> positions, const UnitFrame& frame,
               const Vec3& origin) {
  std::array<Seen, 3> corner;
  for (int k = 0; k < 3; ++k) corner[k] = seen(frame.to_unit(positions[t[k]]), origin);
  // An edge is evaluated from its smaller vertex to its larger: its two faces always agree on the side.
  std::array<double, 3> area;  // opposite to corner k + 2
  int on_left = 0;
  for (int k = 0; k < 3; ++k) {
    const bool forward = mesh::runs_forward(t, k);
    const Vec2 &from = corner[forward ? k : (k + 1) % 3].beside,
               &to = corner[forward ? (k + 1) % 3 : k].beside;
    const double signed_area = cross(from, to);
    area[k] = forward ? signed_area : -signed_area;
    on_left += (side_of_ray(from, to, signed_area) > 0) == forward;
  }
  if (on_left != 0 && on_left != 3) return false;
  const double sum = area[0] + area[1] + area[2];
  if (sum == 0) return false;
  const double along = area[1] * corner[0].along + area[2] * corner[1].along + area[0] * corner[2].along;
  return along / sum > 0;
}

}  // namespace sdm::inside
