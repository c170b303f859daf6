#include "certify/hausdorff/part.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "certify/hausdorff/nearest_face.h"
#include "geometry/rounding.h"
#include "search/mixed_bound.h"

namespace sdm::hausdorff {

std::optional<SideCut> cut_along_side(const Corners& triangle, const Corners& face, const Vec3& normal,
                                      double offset, double margin) {
  Vec3 beyond{};  // of the corners, over the line of the cut
  double farthest = margin;
  for (int k = 0; k < 3; ++k) {
    const Vec3 outward = normalized(cross(face[(k + 1) % 3] - face[k], normal));
    Vec3 distances;
    for (int i = 0; i < 3; ++i) distances[i] = dot(outward, triangle[i] - face[k]) - offset;
    const auto [least, most] = std::minmax({distances[0], distances[1], distances[2]});
    if (most > farthest && least < -margin) {
      farthest = most;
      beyond = distances;
    }
  }
  if (beyond == Vec3{}) return std::nullopt;
  const auto outside = std::ranges::count_if(beyond, [](double distance) { return distance > 0; });
  SideCut cut;
  for (int i = 0; i < 3; ++i)
    if ((beyond[i] > 0) == (outside == 1)) cut.alone = i;
  const double from = beyond[cut.alone];
  for (const int side : {0, 1}) cut.at[side] = from / (from - beyond[(cut.alone + 1 + side) % 3]);
  return cut;
}

double longest_side(const Corners& t) {
  return std::sqrt(
      std::max({squared_norm(t[1] - t[0]), squared_norm(t[2] - t[1]), squared_norm(t[0] - t[2])}));
}

namespace {

double largest(const Vec3& v) {
  return std::max({v[0], v[1], v[2]});
}

double least(const Vec3& v) {
  return std::min({v[0], v[1], v[2]});
}

// The parameter in (0, 1) of the point of a side at which two faces are equally far from it, by regula falsi
// (the Illinois variant), or 0. At its ends the one or the other is closer.
double equally_far(const Vec3& from, const Vec3& to, const Corners& near_from, const Corners& near_to,
                   double tolerance) {
  const auto difference = [&](double t) {
    const Vec3 p = from + t * (to - from);
    return upper_face_distance(p, near_from) - upper_face_distance(p, near_to);
  };
  double lo = 0, hi = 1, at_lo = difference(0), at_hi = difference(1);
  if (!(at_lo < 0 && at_hi > 0)) return 0;
  double t = 0;
  constexpr int kSteps = 24;
  for (int step = 0, side = 0; step < kSteps; ++step) {
    t = lo - at_lo * (hi - lo) / (at_hi - at_lo);
    const double value = difference(t);
    if (std::abs(value) <= tolerance) break;
    if (value < 0) {
      lo = t;
      at_lo = value;
      if (side == -1) at_hi /= 2;
      side = -1;
    } else {
      hi = t;
      at_hi = value;
      if (side == 1) at_lo /= 2;
      side = 1;
    }
  }
  return t;
}

}  // namespace

bool FacePart::add(const sites::SitesData& b, std::uint32_t near_face, double tolerance) {
  const Corners corners = corners_of(b.mesh, near_face);
  const Vec3 d{upper_face_distance(at[0], corners), upper_face_distance(at[1], corners),
               upper_face_distance(at[2], corners)};
  for (int k = 0; k < count; ++k)
    if (b_faces[k] == near_face || largest(distances[k] - d) <= tolerance) return false;
  std::size_t slot = count;
  if (count < kMostFaces) {
    ++count;
  } else {
    double farthest = -1;
    for (std::size_t k = 0; k < kMostFaces; ++k) {
      const double sum = distances[k][0] + distances[k][1] + distances[k][2];
      if ((mixed >> k & 1) == 0 && sum > farthest) {
        farthest = sum;
        slot = k;
      }
    }
  }
  b_faces[slot] = near_face;
  distances[slot] = d;
  return true;
}

void FacePart::bound() {
  const search::MixedBound best = search::mixed_bound(std::span(distances).first(count), -kInfinity);
  upper = (1 + kFewRoundings) * best.value;
  weights = best.weights;
  mixed = 0;
  for (const std::uint32_t k : best.mixed)
    if (k != kNone) mixed |= 1u << k;
}

Vec3 FacePart::highest_point() const {
  return weights[0] * at[0] + weights[1] * at[1] + weights[2] * at[2];
}

int FacePart::support() const {
  return (weights[0] > 0 ? 1 : 0) + (weights[1] > 0 ? 1 : 0) + (weights[2] > 0 ? 1 : 0);
}

int FacePart::closest(int corner) const {
  int best = 0;
  for (int k = 1; k < count; ++k)
    if (distances[k][corner] < distances[best][corner]) best = k;
  return best;
}

namespace {

// The barycentric coordinates in a triangle of the projection of p to its plane.
Vec3 coordinates(const Corners& t, const Vec3& p) {
  const Vec3 side = t[1] - t[0], other = t[2] - t[0], normal = cross(side, other), r = p - t[0];
  const double square = squared_norm(normal);
  const double v = dot(cross(r, other), normal) / square, w = dot(cross(side, r), normal) / square;
  return {1 - v - w, v, w};
}

// The weights, in the part, of a vertex that all mixed faces share, if it is above the inside of the part.
std::optional<Vec3> common_vertex(const FacePart& part, const Mesh& b) {
  std::optional<Corners> first;
  std::array<bool, 3> common{true, true, true};
  for (int k = 0; k < part.count; ++k) {
    if ((part.mixed >> k & 1) == 0) continue;
    const Corners corners = corners_of(b, part.b_faces[k]);
    if (!first) {
      first = corners;
      continue;
    }
    for (int i = 0; i < 3; ++i)
      common[i] = common[i] && std::ranges::find(corners, (*first)[i]) != corners.end();
  }
  constexpr double kInside = 1e-7;
  for (int i = 0; i < 3; ++i)
    if (common[i])
      if (const Vec3 weights = coordinates(part.at, (*first)[i]); least(weights) > kInside) return weights;
  return std::nullopt;
}

// The point of a side to cut it at, by its weights.
Vec3 cut_of_side(const FacePart& part, const Mesh& b, double tolerance) {
  int i = 0;  // the side from corner i to corner j
  double longest = -1;
  const bool on_side = !part.stalled && part.support() == 2;
  for (int k = 0; k < 3; ++k) {
    const int next = k < 2 ? k + 1 : 0;
    if (on_side && part.weights[k] > 0 && part.weights[next] > 0) {
      i = k;
      break;
    }
    if (const double length = squared_norm(part.at[next] - part.at[k]); length > longest) {
      longest = length;
      i = k;
    }
  }
  const int j = i < 2 ? i + 1 : 0;
  double t = 0.5;
  if (const int k = part.closest(i), l = part.closest(j); !part.stalled && k != l) {
    constexpr double kLeast = 1e-7;  // of a side: less does not cut it
    const double s = equally_far(part.at[i], part.at[j], corners_of(b, part.b_faces[k]),
                                 corners_of(b, part.b_faces[l]), tolerance);
    if (s > kLeast && s < 1 - kLeast) t = s;
  }
  Vec3 weights{};
  weights[i] = 1 - t;
  weights[j] = t;
  return weights;
}

/// A point of a part, with its distances to the faces near the part.
struct CutPoint {
  Vec3 at;
  std::array<double, FacePart::kMostFaces> distances;
};

CutPoint cut_point(const FacePart& part, const sites::SitesData& b, int i, int j, double t) {
  CutPoint point{(1 - t) * part.at[i] + t * part.at[j], {}};
  for (int k = 0; k < part.count; ++k)
    point.distances[k] = upper_face_distance(point.at, corners_of(b.mesh, part.b_faces[k]));
  return point;
}

}  // namespace

Pieces cut_along(const FacePart& part, const sites::SitesData& b, std::uint32_t near_face, double enough) {
  constexpr double kOffset = 0.7;  // of `enough`, along the plane; so far from it, the sum of squares is less
  constexpr double kSmall = 1.0 / 8, kMargin = 0.005;  // less is no cut
  Pieces pieces;
  const Corners face = corners_of(b.mesh, near_face);
  if (longest_side(face) < kSmall * longest_side(part.at)) return pieces;
  const Vec3 normal = normalized(cross(face[1] - face[0], face[2] - face[0]));
  if (normal == Vec3{}) return pieces;
  const double offset = kOffset * enough;
  for (const Vec3& corner : part.at)
    if (!(std::abs(dot(normal, corner - face[0])) <= offset)) return pieces;
  const std::optional<SideCut> along = cut_along_side(part.at, face, normal, offset, kMargin * offset);
  if (!along) return pieces;
  const int alone = along->alone;
  const std::array<int, 2> others{(alone + 1) % 3, (alone + 2) % 3};
  std::array<CutPoint, 2> cut;
  for (int side = 0; side < 2; ++side) cut[side] = cut_point(part, b, alone, others[side], along->at[side]);
  const auto add = [&](const std::array<const CutPoint*, 3>& corners) {
    FacePart& piece = pieces.part[pieces.count++] = part;
    ++piece.depth;
    for (int i = 0; i < 3; ++i) {
      if (corners[i] == nullptr) continue;
      piece.at[i] = corners[i]->at;
      for (int k = 0; k < part.count; ++k) piece.distances[k][i] = corners[i]->distances[k];
    }
    piece.bound();
  };
  std::array<const CutPoint*, 3> tip{}, first{}, second{};
  tip[others[0]] = &cut[0];
  tip[others[1]] = &cut[1];
  // The rest, a quadrilateral, is cut from the first point to the opposite corner.
  first[alone] = &cut[0];
  second[alone] = &cut[1];
  second[others[0]] = &cut[0];
  add(tip);
  add(first);
  add(second);
  return pieces;
}

Pieces divide(const FacePart& part, const sites::SitesData& b, double tolerance) {
  std::optional<Vec3> cut;
  if (part.stalled || part.support() == 3) cut = common_vertex(part, b.mesh);
  if (!cut) cut = cut_of_side(part, b.mesh, tolerance);
  const Vec3 point = (*cut)[0] * part.at[0] + (*cut)[1] * part.at[1] + (*cut)[2] * part.at[2];
  std::array<double, FacePart::kMostFaces> distances{};
  for (int k = 0; k < part.count; ++k)
    distances[k] = upper_face_distance(point, corners_of(b.mesh, part.b_faces[k]));
  Pieces pieces;
  for (int i = 0; i < 3; ++i) {
    if (!((*cut)[i] > 0)) continue;
    FacePart& piece = pieces.part[pieces.count++] = part;
    ++piece.depth;
    piece.at[i] = point;
    for (int k = 0; k < part.count; ++k) piece.distances[k][i] = distances[k];
    piece.bound();
  }
  return pieces;
}

}  // namespace sdm::hausdorff
