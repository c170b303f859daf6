#include "bodies/contacts/way_out.h"

#include <cmath>

#include "geometry/vec.h"
#include "sites/closest_on_face.h"

namespace sdm::contacts {
namespace {

// A few faces may be closest in turn, as the two sides at a corner.
constexpr int kMostSteps = 6;
// A face is left behind by this much: only where others are clearly farther away does it not depend on
// rounding which one is closest.
constexpr double kClear = 1.01;
// The least that a step gains, relative to its length: with less, the surface runs along what is closest.
constexpr double kLeastGain = 0.25;

bool lies_along(const Vec3& normal, const Vec3& side) {
  return std::abs(dot(normal, side)) <= kPushSine * norm(side);
}

// The direction in which a point leaves a solid at the closest point of its surface; 0 if it is unknown.
Vec3 outwards(const shape::Body& solid, const SurfacePoint& point, double tolerance) {
  if (std::abs(point.distance) > tolerance)
    return (1 / -point.distance) * point.vector;  // inside: towards the surface, outside: away from it
  const Vec3& normal = internals(solid.sites()).normals.face[point.face];
  const inside::Sides sides = solid.inside().sides().of_face(point.face);
  if (sides == inside::Sides::boundary) return normal;
  return sides == inside::Sides::reversed ? -normal : Vec3{};
}

}  // namespace

void WayOutFinder::find_pieces(const SurfaceAround& around, const Vec3& normal) {
  pieces_.clear();
  const std::vector<Vec3>& positions = around.sites->mesh.positions;
  const auto corner = [&](const Triangle& t, int k) -> const Vec3& { return positions[t[k % 3]]; };
  const auto along = [&](const Vec3& a, const Vec3& b) {
    return lies_along(normal, around.to_other->map.linear(b - a));
  };
  for (const std::uint32_t face : around.faces) {
    const Triangle& t = around.sites->mesh.triangles[face];
    if (along(corner(t, 0), corner(t, 1)) && along(corner(t, 1), corner(t, 2)) &&
        along(corner(t, 2), corner(t, 0)))
      pieces_.push_back({.face = face});
  }
  if (!pieces_.empty()) return;
  for (const std::uint32_t face : around.faces) {
    const Triangle& t = around.sites->mesh.triangles[face];
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      const auto is_end = [&](std::uint32_t v) { return a == v || b == v; };
      if (is_end(around.ends[0]) && is_end(around.ends[1]) && along(corner(t, k), corner(t, k + 1)))
        pieces_.push_back({.face = face,
                           .is_edge = true,
                           .edge = {around.to_other->map(positions[a]), around.to_other->map(positions[b])}});
    }
  }
}

WayOutFinder::OnPiece WayOutFinder::closest_on_pieces(const SurfaceAround& around, const Vec3& at) const {
  OnPiece best;
  double least = kInfinity;
  for (const Piece& piece : pieces_) {
    const Vec3 closest =
        piece.is_edge
            ? closest_on_segment(at, piece.edge[0], piece.edge[1])
            : around.to_other->map(
                  sites::closest_on_face(*around.sites, piece.face, around.from_other->map(at)).point);
    if (const double squared = squared_norm(closest - at); squared < least) {
      least = squared;
      best = {closest, piece.face};
    }
  }
  return best;
}

WayOut WayOutFinder::find(const SurfaceAround& around, const shape::Body& other, const Support& support,
                          const SurfacePoint& point, double tolerance) {
  using enum WayOut::Place;
  const double depth = -support.height;
  // The face is above the point, so that no other part of the surface, if it is not closer, is between them.
  if (-point.distance >= depth - tolerance) return {.place = here};
  if (point.distance > tolerance) return {};
  const sites::SitesData& sites = internals(other.sites());
  const Vec3 &normal = sites.normals.face[support.face],
             &corner = sites.mesh.positions[sites.mesh.triangles[support.face][0]];
  find_pieces(around, normal);
  if (pieces_.empty()) return {};

  SurfacePoint p = point;
  for (int step = 0; step < kMostSteps; ++step) {
    // The distances become deep − s u·n, at least, and below − s u·m, with s the length of the step along u,
    // n the way out at the closest point and m the normal of the face.
    const double below = dot(normal, corner - p.at), missing = kClear * below + p.distance;
    const Vec3 n = outwards(other, p, tolerance);
    if (!(below > tolerance) || n == Vec3{}) return {};
    const Vec3 along = closest_on_pieces(around, p.at - missing * n).at - p.at;
    if (norm(along) < kLeastGain * missing) return {};
    const Vec3 u = normalized(along);
    const double gain = kClear * dot(u, normal) - dot(u, n);
    if (gain < kLeastGain) return {};
    const OnPiece next = closest_on_pieces(around, p.at + (missing / gain) * u);
    p = measure_near(other, next.at, support.face);
    const double deep = -p.distance, now_below = dot(normal, corner - p.at);
    if (deep > now_below + tolerance) return {};  // no longer below the face
    if (deep >= depth - tolerance) return {.place = here};
    if (deep >= now_below - tolerance) return {.place = beside, .point = p, .own_face = next.face};
  }
  return {};
}

}  // namespace sdm::contacts
