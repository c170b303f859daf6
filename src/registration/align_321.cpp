#include <sdm/align.h>
#include <sdm/error.h>

#include <cmath>
#include <string>
#include <vector>

#include "mesh/similarity.h"
#include "mesh/validate.h"

namespace sdm {
namespace {

/// The frame of three primary, two secondary and one tertiary point: z is the normal of the plane of the
/// first three, x the direction from the fourth to the fifth in it. The origin is in the plane, on the line
/// of the secondary points as seen along z, and has the place of the sixth point along x. Rows are the axes.
core::Affine datum_frame(std::span<const Vec3> points, const std::string& whose) {
  constexpr double kLeast = 1e-6;  // the sine of an angle below which a direction is not determined
  const Vec3 a = points[1] - points[0], b = points[2] - points[0], normal = cross(a, b);
  if (!(norm(normal) > kLeast * norm(a) * norm(b)))
    throw Error("the three primary points " + whose + " are on a line");
  const Vec3 z = normalized(normal), along = points[4] - points[3], x = along - dot(along, z) * z;
  if (!(norm(x) > kLeast * norm(along)))
    throw Error("the two secondary points " + whose + " are above each other on the primary plane");
  core::Affine frame;
  frame.rows = {normalized(x), cross(z, normalized(x)), z};
  frame.offset = {-dot(frame.rows[0], points[5]), -dot(frame.rows[1], points[3]),
                  -dot(frame.rows[2], points[0])};
  return frame;
}

}  // namespace

Transform align_321(std::span<const Vec3> points, std::span<const Vec3> places) {
  constexpr std::size_t kCount = 6;
  if (points.size() != kCount || places.size() != kCount)
    throw Error("a 3-2-1 alignment needs six points of O1 and their six places on O2");
  for (const std::span<const Vec3> side : {points, places})
    for (const Vec3& p : side)
      for (const double coordinate : p)
        if (!(std::abs(coordinate) <= mesh::kMaxCoordinate))
          throw Error("a point of the 3-2-1 alignment has a coordinate that is NaN or beyond 1e37");
  // Relative to the first points, so that large coordinates do not cancel.
  std::vector<Vec3> from(points.begin(), points.end()), to(places.begin(), places.end());
  for (Vec3& p : from) p = p - points[0];
  for (Vec3& p : to) p = p - places[0];
  const core::Affine map = inverse(datum_frame(to, "on O2")) * datum_frame(from, "of O1");
  core::Affine moved = map;
  moved.offset = map(-points[0]) + places[0];
  return mesh::Similarity{moved, 1}.transform();
}

}  // namespace sdm
