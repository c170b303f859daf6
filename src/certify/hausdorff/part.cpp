#include "certify/hausdorff/part.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "certify/hausdorff/face_distance.h"
#include "certify/hausdorff/nearest_face.h"
#include "geometry/vec.h"

namespace sdm::hausdorff {
namespace {

double largest(const Vec3& v) {
  return std::max({v[0], v[1], v[2]});
}

double least(const Vec3& v) {
  return std::min({v[0], v[1], v[2]});
}

// v scaled to the sum 1; NaN if the sum is 0.
Vec3 barycentric(const Vec3& v) {
  return (1 / (v[0] + v[1] + v[2])) * v;
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
      lo = t, at_lo = value;
      if (side == -1) at_hi /= 2;
      side = -1;
    } else {
      hi = t, at_hi = value;
      if (side == 1) at_lo /= 2;
      side = 1;
    }
  }
  return t;
}

}  // namespace

bool Part::add(const sites::SitesData& b, std::uint32_t near_face, double tolerance) {
  const Corners corners = corners_of(b.mesh, near_face);
  const Vec3 d{upper_face_distance(at[0], corners), upper_face_distance(at[1], corners),
               upper_face_distance(at[2], corners)};
  for (int k = 0; k < count; ++k)
    if (near[k] == near_face || largest(distances[k] - d) <= tolerance) return false;
  std::size_t slot = count;
  if (count < kMostFaces) {
    ++count;
  } else {
    double farthest = -1;
    for (std::size_t k = 0; k < kMostFaces; ++k) {
      const double sum = distances[k][0] + distances[k][1] + distances[k][2];
      if ((mixed >> k & 1) == 0 && sum > farthest) farthest = sum, slot = k;
    }
  }
  near[slot] = near_face, distances[slot] = d;
  return true;
}

// By the theory of linear programs, the smallest maximum is attained by a mixture of one, two or three faces
// for which as many corners have the same value. All of these are tried: each is a bound.
void Part::bound() {
  upper = std::numeric_limits<double>::infinity();
  const std::size_t n = count;
  const auto& d = distances;
  for (std::size_t k = 0; k < n; ++k)
    if (const double value = largest(d[k]); value < upper) {
      upper = value, mixed = 1u << k;
      weights = {};
      weights[static_cast<std::size_t>(std::ranges::max_element(d[k]) - d[k].begin())] = 1;
    }
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t l = 0; l < k; ++l)
      for (std::size_t i = 0; i < 3; ++i) {
        // (1 − t) d[k] + t d[l] has the same value at corners i and j.
        const std::size_t j = i < 2 ? i + 1 : 0;
        const double rise_k = d[k][j] - d[k][i], rise_l = d[l][j] - d[l][i];
        if (!(rise_k * rise_l < 0)) continue;
        const double t = rise_k / (rise_k - rise_l);
        const Vec3 mixture = (1 - t) * d[k] + t * d[l];
        const double value = std::max(mixture[i], mixture[j]);
        if (!(value < upper) || mixture[3 - i - j] > value) continue;
        // Where l_k and l_l are equal on the side.
        const double first = d[k][i] - d[l][i], second = d[l][j] - d[k][j], s = first / (first + second);
        if (!(s >= 0 && s <= 1)) continue;
        upper = value, mixed = 1u << k | 1u << l;
        weights = {};
        weights[i] = 1 - s, weights[j] = s;
      }
  for (std::size_t k = 2; k < n; ++k)
    for (std::size_t l = 1; l < k; ++l)
      for (std::size_t m = 0; m < l; ++m) {
        const Vec3 x{d[k][1] - d[k][0], d[l][1] - d[l][0], d[m][1] - d[m][0]},
            y{d[k][2] - d[k][0], d[l][2] - d[l][0], d[m][2] - d[m][0]};
        const Vec3 mu = barycentric(cross(x, y));
        const double value = largest(mu[0] * d[k] + mu[1] * d[l] + mu[2] * d[m]);
        if (!(least(mu) > 0 && value < upper)) continue;
        const Vec3 highest = barycentric(cross(d[l] - d[k], d[m] - d[k]));
        if (!(least(highest) >= 0)) continue;
        upper = value, mixed = 1u << k | 1u << l | 1u << m;
        weights = highest;
      }
  constexpr double kRounding = 1e-15;
  upper *= 1 + kRounding;
}

Vec3 Part::highest_point() const {
  return weights[0] * at[0] + weights[1] * at[1] + weights[2] * at[2];
}

int Part::support() const {
  return (weights[0] > 0 ? 1 : 0) + (weights[1] > 0 ? 1 : 0) + (weights[2] > 0 ? 1 : 0);
}

int Part::closest(int corner) const {
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

// Of a vertex that all mixed faces share and that is above the inside of the part, if there is one.
std::optional<Vec3> common_vertex(const Part& part, const Mesh& b) {
  std::optional<Corners> first;
  std::array<bool, 3> common{true, true, true};
  for (int k = 0; k < part.count; ++k) {
    if ((part.mixed >> k & 1) == 0) continue;
    const Corners corners = corners_of(b, part.near[k]);
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
Vec3 cut_of_side(const Part& part, const Mesh& b, double tolerance) {
  int i = 0;  // the side from corner i to corner j
  double longest = -1;
  const bool on_side = !part.stalled && part.support() == 2;
  for (int k = 0; k < 3; ++k) {
    const int next = k < 2 ? k + 1 : 0;
    if (on_side && part.weights[k] > 0 && part.weights[next] > 0) {
      i = k;
      break;
    }
    if (const double length = squared_norm(part.at[next] - part.at[k]); length > longest)
      longest = length, i = k;
  }
  const int j = i < 2 ? i + 1 : 0;
  double t = 0.5;
  if (const int k = part.closest(i), l = part.closest(j); !part.stalled && k != l) {
    constexpr double kLeast = 1e-7;  // of a side: less does not cut it
    const double s = equally_far(part.at[i], part.at[j], corners_of(b, part.near[k]),
                                 corners_of(b, part.near[l]), tolerance);
    if (s > kLeast && s < 1 - kLeast) t = s;
  }
  Vec3 weights{};
  weights[i] = 1 - t, weights[j] = t;
  return weights;
}

}  // namespace

Pieces divide(const Part& part, const sites::SitesData& b, double tolerance) {
  std::optional<Vec3> cut;
  if (part.stalled || part.support() == 3) cut = common_vertex(part, b.mesh);
  if (!cut) cut = cut_of_side(part, b.mesh, tolerance);
  const Vec3 point = (*cut)[0] * part.at[0] + (*cut)[1] * part.at[1] + (*cut)[2] * part.at[2];
  std::array<double, Part::kMostFaces> distances{};
  for (int k = 0; k < part.count; ++k)
    distances[k] = upper_face_distance(point, corners_of(b.mesh, part.near[k]));
  Pieces pieces;
  for (int i = 0; i < 3; ++i) {
    if (!((*cut)[i] > 0)) continue;
    Part& piece = pieces.part[pieces.count++] = part;
    ++piece.depth;
    piece.at[i] = point;
    for (int k = 0; k < part.count; ++k) piece.distances[k][i] = distances[k];
    piece.bound();
  }
  return pieces;
}

}  // namespace sdm::hausdorff
