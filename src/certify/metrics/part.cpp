#include "certify/metrics/part.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "certify/hausdorff/face_distance.h"
#include "geometry/point_triangle.h"
#include "geometry/rounding.h"
#include "geometry/vec.h"
#include "query/closest/blocks.h"
#include "query/closest/closest_points.h"
#include "tree/visit.h"

namespace sdm::metrics {
namespace {

constexpr double kLeastLength = 1e-140;  // of a direction: its square does not underflow

double sum(const Vec3& v) {
  return v[0] + v[1] + v[2];
}

double largest(const Vec3& v) {
  return std::max({v[0], v[1], v[2]});
}

/// The distances of the corners to a face of B, rounded upwards.
Vec3 upper_distances(const sites::SitesData& b, const Part& part, std::uint32_t face) {
  const Corners near = corners_of(b.mesh, face);
  Vec3 distances;
  for (int i = 0; i < 3; ++i) distances[i] = hausdorff::upper_face_distance(part.corner[i].at, near);
  return distances;
}

/// √(dᵢ² − G), or zeros if one of them is not real.
Vec3 lower_by_size(const Part& part) {
  const double most = (1 + kProductRounding) * part.squared_size() / 3;
  Vec3 low;
  for (int i = 0; i < 3; ++i) {
    const double d = part.corner[i].lower, squared = (1 - kFewRoundings) * d * d - most;
    if (!(squared > 0)) return {};
    low[i] = (1 - kFewRoundings) * std::sqrt(squared);
  }
  return low;
}

// g·x − max of g·y over the face, at the corners x of the part.
Vec3 along(const Vec3& g, const Part& part, const Corners& face) {
  Vec3 low;
  for (int i = 0; i < 3; ++i) {
    double least = std::numeric_limits<double>::infinity();
    for (const Vec3& y : face) {
      const Vec3 r = part.corner[i].at - y;
      const double rounding =
          kProductRounding * (std::abs(r[0]) + std::abs(r[1]) + std::abs(r[2]));  // of g and of the product
      least = std::min(least, dot(g, r) - rounding);
    }
    low[i] = least;
  }
  return low;
}

// A linear lower bound on the distance to a face: of those along its normal and along the way from its
// closest point to the middle, the one that is the least below `high`.
Vec3 lower_bound(const Part& part, const Corners& face) {
  const Vec3 middle = part.middle();
  const auto loss = [&](const Vec3& low) {
    double total = 0;
    for (int i = 0; i < 3; ++i) total += std::max(0.0, part.high[i] - low[i]);
    return total;
  };
  Vec3 best{};
  double least = loss(best);
  const auto offer = [&](const Vec3& direction) {
    const double length = norm(direction);
    if (!(length > kLeastLength)) return;
    const Vec3 low = along((1 / length) * direction, part, face);
    if (const double l = loss(low); l < least) best = low, least = l;
  };
  const Vec3 normal = cross(face[1] - face[0], face[2] - face[0]);
  offer(dot(normal, middle - face[0]) < 0 ? -1.0 * normal : normal);
  if (least > 0) offer(middle - core::closest_on_triangle(middle, face));
  return best;
}

// Lowers `high` if the distance to this face is less.
void offer(const sites::SitesData& b, std::uint32_t face, Part& part) {
  if (const Vec3 high = upper_distances(b, part, face); sum(high) < sum(part.high)) part.high = high;
}

}  // namespace

std::vector<MeasuredPoint> measure(const sites::SitesData& b, std::span<const Vec3> points, double accuracy,
                                   const Progress& progress) {
  std::vector<MeasuredPoint> result(points.size());
  closest::for_each_block(points.size(), progress, "parts", [&](std::size_t begin, std::size_t end) {
    closest::closest_points(
        b, points.subspan(begin, end - begin), kInfinity,
        [&](std::size_t first, const sites::ClosestPacket& closest) {
          for (std::size_t i = 0; i < closest.count; ++i) {
            const Vec3& p = points[begin + first + i];
            const std::uint32_t face = b.face_of(closest.type[i], closest.site[i]);
            const double upper = hausdorff::upper_face_distance(p, corners_of(b.mesh, face));
            result[begin + first + i] = {p, face, std::max(0.0, closest.distance[i] - accuracy), upper};
          }
        });
  });
  return result;
}

double Part::gap() const {
  return largest(high - low);
}

double Part::squared_size() const {
  const int i = longest_side();
  return squared_norm(corner[(i + 1) % 3].at - corner[i].at);
}

int Part::longest_side() const {
  int longest = 0;
  double most = -1;
  for (int i = 0; i < 3; ++i)
    if (const double squared = squared_norm(corner[(i + 1) % 3].at - corner[i].at); squared > most)
      most = squared, longest = i;
  return longest;
}

Vec3 Part::middle() const {
  return (1.0 / 3) * (corner[0].at + corner[1].at + corner[2].at);
}

Vec3 Part::middle_of_side() const {
  const int i = longest_side();
  return 0.5 * (corner[i].at + corner[(i + 1) % 3].at);
}

void bound(const sites::SitesData& b, Part& part) {
  offer(b, part.nearest, part);  // often less far from all corners than the faces that are closest to one
  for (int i = 0; i < 3; ++i) {
    const std::uint32_t face = part.corner[i].nearest;
    if (face != part.nearest && (i == 0 || face != part.corner[i - 1].nearest)) offer(b, face, part);
  }
  if (const Vec3 low = lower_by_size(part); Linear(low).mean() > part.lower().mean()) part.low = low;
}

void bound_thoroughly(const sites::SitesData& b, Part& part) {
  constexpr int kMostFaces = 48;  // more are nearly equally far, where lower_by_size() is close
  part.thorough = true;
  if (part.high == Vec3{}) return;
  Box box;
  double size = 1;
  for (const MeasuredPoint& corner : part.corner) {
    const Vec3 unit = b.frame.to_unit(corner.at);
    extend(box, unit);
    for (const double x : unit) size = std::max(size, std::abs(x));
  }
  const tree::FloatBox around = tree::FloatBox::around(box);
  const double reach = (1 + kProductRounding) * largest(part.high) * b.frame.scale + kProductRounding * size;
  // Faces farther than `reach` are closest nowhere, or as far as `high` is anyway.
  Vec3 low = part.high;
  int faces = 0;
  const auto gap_to = [&](const tree::FloatBox& other) { return norm(tree::gap(around, other)); };
  const auto enter = [&](double distance) { return faces <= kMostFaces && distance <= reach; };
  const auto leaf = [&](std::uint32_t node) {
    for (const std::uint32_t face : b.tree.items_of(node)) {
      if (++faces > kMostFaces) return;
      const Vec3 bound = lower_bound(part, corners_of(b.mesh, face));
      for (int i = 0; i < 3; ++i) low[i] = std::min(low[i], bound[i]);
    }
  };
  tree::visit(b.tree, tree::NearestFirst{gap_to, enter, leaf});
  if (faces <= kMostFaces && Linear(low).mean() > part.lower().mean()) part.low = low;
}

std::array<Part, 2> halves(const Part& part, const MeasuredPoint& middle_of_side) {
  const int i = part.longest_side(), j = (i + 1) % 3;
  std::array<Part, 2> halves{part, part};
  halves[0].corner[j] = halves[1].corner[i] = middle_of_side;
  halves[0].low[j] = halves[1].low[i] = 0.5 * (part.low[i] + part.low[j]);
  halves[0].high[j] = halves[1].high[i] = 0.5 * (part.high[i] + part.high[j]);
  for (Part& half : halves) half.area = part.area / 2, half.thorough = false;
  return halves;
}

}  // namespace sdm::metrics
