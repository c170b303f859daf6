#include "simplify/high_parts.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "certify/hausdorff/nearest_face.h"
#include "certify/hausdorff/vertex_search.h"
#include "closest/blocks.h"
#include "closest/closest_points.h"
#include "geometry/clip.h"
#include "geometry/rounding.h"
#include "geometry/spatial_order.h"

namespace sdm::simplify {
namespace {

// Parts are no smaller than these fractions of the limit, and of the mean length of an edge of B.
constexpr double kOfLimit = 0.2, kOfEdge = 0.3;

Vec3 middle_of(const Corners& t) {
  return (1.0 / 3) * (t[0] + t[1] + t[2]);
}

double reach_of(const Corners& t, const Vec3& p) {
  return std::sqrt(std::max({squared_norm(t[0] - p), squared_norm(t[1] - p), squared_norm(t[2] - p)}));
}

double mean_edge(const Mesh& mesh) {
  double area = 0;
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    const auto [a, b, c] = corners_of(mesh, f);
    area += norm(cross(b - a, c - a)) / 2;
  }
  return std::sqrt(2 * area / static_cast<double>(mesh.triangles.size()));
}

// An upper bound on the distances of all points of a part to B, near whose middle p is a face: distances are
// 1-Lipschitz, and that to the face is convex.
double upper_bound(const Corners& part, const Vec3& p, const Corners& near) {
  const double around = hausdorff::upper_face_distance(p, near) + reach_of(part, p);
  const double corners =
      std::max({hausdorff::upper_face_distance(part[0], near), hausdorff::upper_face_distance(part[1], near),
                hausdorff::upper_face_distance(part[2], near)});
  return (1 + kDoubleRounding) * std::min(around, corners);
}

/// A piece of a face.
struct Piece {
  Corners at;
  std::uint32_t divisions = 0;
};

/// A polygon that stays convex; a triangle that was cut three times has at most six corners.
using Polygon = std::vector<Vec3>;

// Triangles of a polygon, from its first corner.
void add_triangles(const Polygon& polygon, std::uint32_t divisions, std::vector<Piece>& pieces) {
  for (std::size_t i = 2; i < polygon.size(); ++i)
    pieces.push_back({{polygon[0], polygon[i - 1], polygon[i]}, divisions});
}

double double_area(const Polygon& polygon) {
  Vec3 sum{};
  for (std::size_t i = 2; i < polygon.size(); ++i)
    sum = sum + cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
  return norm(sum);
}

Polygon clipped(const Polygon& polygon, const std::vector<double>& height) {
  Polygon result;
  clip_convex(
      height, [&](std::size_t i) { result.push_back(polygon[i]); },
      [&](std::size_t i, std::size_t j, double t) {
        result.push_back(polygon[i] + t * (polygon[j] - polygon[i]));
      });
  return result;
}

class Division {
 public:
  Division(const sites::SitesData& b, double limit, double least) : b_(b), limit_(limit), least_(least) {}

  // Pieces for which no division helps go to `high`; parts of others stay.
  void divide(std::vector<Piece>& pieces, std::vector<Corners>& high, const Progress& progress) const {
    std::vector<Vec3> middles;
    middles.reserve(pieces.size());
    for (const Piece& piece : pieces) middles.push_back(middle_of(piece.at));
    std::vector<std::uint32_t> near(pieces.size(), kNone);  // kNone: within the limit
    closest::for_each_block(middles.size(), progress, "parts", [&](std::size_t begin, std::size_t end) {
      closest::closest_points(
          b_, std::span(middles).subspan(begin, end - begin), kInfinity,
          [&](std::size_t first, const sites::ClosestPacket& closest) {
            for (std::size_t i = 0; i < closest.count; ++i) {
              const std::size_t at = begin + first + i;
              const std::uint32_t face = b_.face_of(closest.type[i], closest.site[i]);
              if (upper_bound(pieces[at].at, middles[at], corners_of(b_.mesh, face)) > limit_)
                near[at] = face;
            }
          });
    });
    std::vector<Piece> smaller;
    for (std::size_t i = 0; i < pieces.size(); ++i)
      if (near[i] != kNone) divide(pieces[i], middles[i], corners_of(b_.mesh, near[i]), smaller, high);
    pieces = std::move(smaller);
  }

 private:
  static constexpr std::uint32_t kMostDivisions = 24;
  /// More pieces are searched as they are: those of two divisions take 320 MB.
  static constexpr std::size_t kMostPieces = std::size_t{1} << 21;

  void divide(const Piece& piece, const Vec3& middle, const Corners& near, std::vector<Piece>& smaller,
              std::vector<Corners>& high) const {
    constexpr double kLarger = 2;  // than the face near it
    const double reach = reach_of(piece.at, middle);
    if (piece.divisions == kMostDivisions || smaller.size() > kMostPieces)
      high.push_back(piece.at);
    else if (reach > kLarger * reach_of(near, middle_of(near)))
      quarter(piece, smaller);
    else if (cut(piece, near, smaller))
      return;
    else if (reach < least_)
      high.push_back(piece.at);
    else
      quarter(piece, smaller);
  }

  static void quarter(const Piece& piece, std::vector<Piece>& smaller) {
    const Corners& t = piece.at;
    const Vec3 a = 0.5 * (t[0] + t[1]), b = 0.5 * (t[1] + t[2]), c = 0.5 * (t[2] + t[0]);
    for (const Corners& part :
         {Corners{t[0], a, c}, Corners{a, t[1], b}, Corners{a, b, c}, Corners{c, b, t[2]}})
      smaller.push_back({part, piece.divisions + 1});
  }

  // What is above a face of B is as far from its plane, so that the largest distance is at a corner. Adds the
  // rest, if that is within the limit; returns false, and adds nothing, otherwise.
  bool cut(const Piece& piece, const Corners& near, std::vector<Piece>& smaller) const {
    const Vec3 normal = cross(near[1] - near[0], near[2] - near[0]);
    const std::size_t before = smaller.size();
    Polygon inside(piece.at.begin(), piece.at.end());
    for (int k = 0; k < 3 && inside.size() > 2; ++k) {
      const Vec3 inwards = cross(normal, near[(k + 1) % 3] - near[k]);
      std::vector<double> height;
      for (const Vec3& p : inside) height.push_back(dot(inwards, p - near[k]));
      Polygon rest = clipped(inside, height);
      for (double& h : height) h = -h;
      add_triangles(clipped(inside, height), piece.divisions + 1, smaller);
      inside = std::move(rest);
    }
    const auto within = [&](const Vec3& p) {
      return (1 + kDoubleRounding) * hausdorff::upper_face_distance(p, near) <= limit_;
    };
    constexpr double kLeastShare = 0.05;  // of the area: less is no progress
    if (double_area(inside) > kLeastShare * double_area({piece.at.begin(), piece.at.end()}) &&
        std::ranges::all_of(inside, within))
      return true;
    smaller.resize(before);
    return false;
  }

  const sites::SitesData& b_;
  double limit_, least_;
};

}  // namespace

Mesh parts_above(const Mesh& mesh, const sites::SitesData& b, double limit, const Progress& progress) {
  std::vector<Vec3> middles;
  std::vector<std::uint32_t> faces;
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    if (hausdorff::repeats_corner(mesh.triangles[f])) continue;
    middles.push_back(middle_of(corners_of(mesh, f)));
    faces.push_back(f);
  }
  std::vector<Piece> pieces;
  std::vector<Corners> high;
  pieces.reserve(faces.size());
  for (const std::uint32_t i : spatial_order(middles)) pieces.push_back({corners_of(mesh, faces[i])});
  const Division division(b, limit, std::max(kOfLimit * limit, kOfEdge * mean_edge(b.mesh)));
  while (!pieces.empty()) division.divide(pieces, high, progress);
  Mesh result;
  for (const Corners& part : high) {
    const auto first = static_cast<std::uint32_t>(result.positions.size());
    result.positions.insert(result.positions.end(), part.begin(), part.end());
    result.triangles.push_back({first, first + 1, first + 2});
  }
  return result;
}

}  // namespace sdm::simplify
