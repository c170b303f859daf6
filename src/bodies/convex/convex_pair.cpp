#include "bodies/convex/convex_pair.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "bodies/convex/touching.h"
#include "geometry/predicates.h"
#include "geometry/triangle_pair.h"

// The proof of a result. Let u be the unit vector from the closest point of O1 to that of O2, d their
// distance, and r a bound on rounding errors. Heights are along u for O1, along −u for O2.
//
// 1. If a vertex is higher than all of its neighbours by h, it is higher than all vertices by h, as the
// surface
//    is convex: a path of neighbours leads up from any vertex, and ends there. The same for an edge across u,
//    and its ends. A face is the highest if it sees the other closest point.
// 2. So the points are closest, and only faces that contain the vertex, an end of the edge, or the face
// itself,
//    have distances below d + h. Points of them that are no lower than 2 r are within 2 r · size / h of the
//    vertex or the edge.
// 3. If the closest point of an edge or a face is at least l from its ends or sides, seen along u, and 2 r ·
//    size / h < l / 4, other faces have points that are l / 4 aside: √(d² + l² / 16) > d + 2 r. Or they are
//    beneath the face: by l / 2 · inner radius / size, as the hull of the face and the centre is solid.
//
// So the faces at the vertex, both faces at the edge, and the face, are those at distance d, to rounding, and
// all others are farther. The result is that of the smallest numbers, as pairs::find_closest() has it.
//
// 4. Where the distance is no more than rounding, of a vertex and a face, or of two edges, u is the normal of
//    the face, or of both edges, which does not depend on the distance. By 1 to 3, only faces at these
//    features can have a point in common; and as all other vertices are beyond them by more than rounding,
//    they have none if and only if the vertex is outside of the plane of the face, or one edge beyond the
//    other: one exact predicate. If the vertex is on the inside by 4 r at most, an edge from it leaves
//    through the face, within 4 r · size / h of the vertex; so does an edge through the faces of the other
//    one.
namespace sdm::convex {
namespace {

constexpr double kPosedRounding = 1.6e-14;  // of a posed vertex and of distances, relative to all lengths
constexpr double kLeastDrop = 1e-8;         // of the sizes: what exceeds the error of a direction
constexpr double kReliable = 1e-4;          // error of a direction, which the drop exceeds
constexpr double kMany = 64;                // roundings that are nothing beside a length

// The different vertices of a side of a simplex.
struct Feature {
  std::uint32_t count = 0;
  std::array<std::uint32_t, 3> vertex{};

  Feature(const Simplex& simplex, int side) {
    for (std::uint32_t i = 0; i < simplex.count; ++i)
      if (const std::uint32_t v = simplex.vertices[i][side]; !contains(v)) vertex[count++] = v;
  }
  [[nodiscard]] bool contains(std::uint32_t v) const {
    return std::ranges::find(vertices(), v) != vertices().end();
  }
  [[nodiscard]] std::span<const std::uint32_t> vertices() const { return {vertex.data(), count}; }
};

// The features of a triangle that contain all of the vertices.
Features features_at(const Triangle& triangle, std::span<const std::uint32_t> vertices) {
  Features result{.corners = 7, .sides = 7};
  for (const std::uint32_t v : vertices) {
    const unsigned at = (triangle[0] == v ? 1 : 0) | (triangle[1] == v ? 2 : 0) | (triangle[2] == v ? 4 : 0);
    const unsigned ends_there = (at >> 1 | at << 2) & 7;  // the sides before these corners
    result.corners &= at;
    result.sides &= at | ends_there;
  }
  return result;
}

enum class Proven : std::uint8_t {
  nothing,
  apart,        // the features are closest, and have no point in common
  intersecting  // those of the surfaces that are near each other are the features, which have one
};

// Finds the faces of the closest points, and proves that they are.
class Proof {
 public:
  Proof(const std::array<const ConvexMesh*, 2>& meshes, const pairs::MeshPair& pair, double scale,
        double rounding, const Simplex& simplex)
      : meshes_(meshes),
        pair_(pair),
        scale_(scale),
        rounding_(rounding),
        away_(simplex.away),
        features_{Feature(simplex, 0), Feature(simplex, 1)} {
    size_ = meshes[0]->size + scale * meshes[1]->size;
    for (int side = 0; side < 2; ++side) faces_[side] = meshes[side]->first_face[features_[side].vertex[0]];
  }

  // Faces near the closest ones, or those.
  [[nodiscard]] const pairs::FacePair& faces() const { return faces_; }

  Proven find() {
    const std::uint32_t n1 = features_[0].count, n2 = features_[1].count;
    if (n1 == 1 && n2 == 1) return of_vertices();
    if (n1 == 2 && n2 == 2) return of_edges();
    if (n1 == 1 || n2 == 1) {
      const int vertex_side = n1 == 1 ? 0 : 1;
      return features_[1 - vertex_side].count == 2 ? of_vertex_and_edge(vertex_side)
                                                   : of_vertex_and_face(vertex_side);
    }
    return Proven::nothing;
  }

  // The closest points of both faces, which are those of the features. Requires Proven::apart.
  [[nodiscard]] PointPair points_of_features() const {
    Corners face[2];
    Features at[2];
    for (int side = 0; side < 2; ++side) {
      const Feature& feature = features_[side];
      std::array<std::uint32_t, 3> numbers{};
      for (std::uint32_t i = 0; i < feature.count; ++i) numbers[i] = meshes_[side]->vertex[feature.vertex[i]];
      face[side] = corners(side, faces_[side]);
      if (feature.count < 3)
        at[side] = features_at(triangle(side, faces_[side]), {numbers.data(), feature.count});
    }
    return closest_points(face[0], at[0], face[1], at[1]);
  }

 private:
  [[nodiscard]] Vec3 point(int side, std::uint32_t vertex) const {
    return side == 0 ? meshes_[0]->points[vertex] : pair_.point2(vertex);
  }
  [[nodiscard]] Corners corners(int side, std::uint32_t face) const {
    return side == 0 ? pair_.face1(face) : pair_.face2(face);
  }
  [[nodiscard]] const Triangle& triangle(int side, std::uint32_t face) const {
    return (side == 0 ? pair_.o1 : pair_.o2).mesh.triangles[face];
  }

  // How much higher the feature of a side is than the rest, along u for O1 and −u for O2.
  [[nodiscard]] double drop(int side, const Vec3& u) const {
    const ConvexMesh& mesh = *meshes_[side];
    const auto& rows = pair_.pose.rows;
    const Vec3 up = side == 0 ? u : -(u[0] * rows[0] + u[1] * rows[1] + u[2] * rows[2]);
    double least = kInfinity;
    for (const std::uint32_t v : features_[side].vertices())
      for (const Spoke& spoke : mesh.spokes.of(v))
        if (!features_[side].contains(spoke.end))
          least = std::min(least, dot(up, mesh.points[v] - mesh.points[spoke.end]));
    return least;
  }
  // Whether the feature is the highest; within the drop, its points are `lateral` from its ends.
  [[nodiscard]] bool highest(int side, const Vec3& u, double u_error, double lateral) const {
    const double h = drop(side, u);
    return h > (kLeastDrop + u_error) * size_ + kMany * rounding_ &&
           8 * rounding_ * size_ < 0.25 * lateral * h;
  }
  [[nodiscard]] bool aside(double lateral, double distance) const {
    return lateral * lateral > 16 * kMany * rounding_ * (distance + rounding_);
  }

  struct Edge {
    Vec3 from{}, along{};
  };
  // The edge of the feature, and its first face; empty if its vertices are no neighbours.
  std::optional<Edge> edge(int side) {
    const auto& [a, b, unused] = features_[side].vertex;
    for (const Spoke& spoke : meshes_[side]->spokes.of(a)) {
      if (spoke.end != b) continue;
      faces_[side] = spoke.first_face();
      const Vec3 from = point(side, a);
      return Edge{from, point(side, b) - from};
    }
    return {};
  }
  // The relation of two features that have this height above each other, to rounding, and are closest if it
  // is positive. `exact_sign` computes the sign of the height where rounding may change it.
  template <class ExactSign>
  [[nodiscard]] Proven by_height(double height, const ExactSign& exact_sign) const {
    if (height > kMany * rounding_) return Proven::apart;
    if (!(height > -4 * rounding_)) return Proven::nothing;
    return exact_sign() > 0 ? Proven::apart : Proven::intersecting;
  }

  Proven of_vertices() const {
    const Vec3 between = point(1, features_[1].vertex[0]) - point(0, features_[0].vertex[0]);
    const double distance = norm(between);
    const double u_error = 4 * rounding_ / distance;
    if (!(u_error < kReliable)) return Proven::nothing;
    const Vec3 u = (1 / distance) * between;
    for (int side = 0; side < 2; ++side)
      if (!highest(side, u, u_error, size_)) return Proven::nothing;
    return Proven::apart;
  }

  Proven of_vertex_and_edge(int vertex_side) {
    const int edge_side = 1 - vertex_side;
    const std::optional<Edge> e = edge(edge_side);
    if (!e) return Proven::nothing;
    const Vec3 p = point(vertex_side, features_[vertex_side].vertex[0]), along = e->along;
    const double squared = squared_norm(along), t = dot(p - e->from, along) / squared;
    const double lateral = std::min(t, 1 - t) * std::sqrt(squared);
    const Vec3 q = e->from + t * along, between = vertex_side == 0 ? q - p : p - q;
    const double distance = norm(between), u_error = 8 * rounding_ / distance;
    if (!(u_error < kReliable) || !(lateral > 0) || !aside(lateral, distance)) return Proven::nothing;
    const Vec3 u = (1 / distance) * between;
    const bool proven = highest(vertex_side, u, u_error, lateral) && highest(edge_side, u, u_error, lateral);
    return proven ? Proven::apart : Proven::nothing;
  }

  Proven of_edges() {
    const std::optional<Edge> e1 = edge(0), e2 = edge(1);
    if (!e1 || !e2) return Proven::nothing;
    const Vec3 &a = e1->along, &b = e2->along, n = cross(a, b), r = e2->from - e1->from;
    const double length1 = norm(a), length2 = norm(b), length = norm(n);
    const double sine = length / (length1 * length2);
    const double u_error = 8 * rounding_ / (sine * std::min(length1, length2));
    if (!(u_error < kReliable)) return Proven::nothing;
    const double s = dot(cross(r, b), n) / (length * length), t = dot(cross(r, a), n) / (length * length);
    const double lateral = sine * std::min(std::min(s, 1 - s) * length1, std::min(t, 1 - t) * length2);
    const int outwards = dot(n, away_) < 0 ? 1 : -1;
    const double height = outwards * dot(r, n) / length;
    if (!(lateral > 0) || !aside(lateral, std::abs(height))) return Proven::nothing;
    const Vec3 u = (outwards / length) * n;
    if (!highest(0, u, u_error, lateral) || !highest(1, u, u_error, lateral)) return Proven::nothing;
    return by_height(height, [&] {
      // The sign of −r·n.
      return -outwards * orientation(e1->from, point(0, features_[0].vertex[1]), e2->from,
                                     point(1, features_[1].vertex[1]));
    });
  }

  Proven of_vertex_and_face(int vertex_side) {
    const Vec3 p = point(vertex_side, features_[vertex_side].vertex[0]);
    const int face_side = 1 - vertex_side;
    const ConvexMesh& mesh = *meshes_[face_side];
    // Any of the faces in one plane may have the closest point. Each is met at two spokes of a vertex.
    const auto& [a, b, c] = features_[face_side].vertex;
    const Vec3 normal = normalized(cross(mesh.points[b] - mesh.points[a], mesh.points[c] - mesh.points[a]));
    constexpr double kSamePlane = 1 - 1e-6;  // cosine
    std::uint32_t tried = kNone;
    for (const std::uint32_t v : features_[face_side].vertices())
      for (const Spoke& spoke : mesh.spokes.of(v))
        for (const std::uint32_t face : spoke.faces) {
          if (face == tried || std::abs(dot(normal, mesh.normals[face])) < kSamePlane) continue;
          tried = face;
          const Proven proven = of_vertex_over(vertex_side, p, face);
          if (proven == Proven::nothing) continue;
          faces_[face_side] = face;
          return proven;
        }
    return Proven::nothing;
  }
  // Whether the face has the point closest to the vertex p.
  [[nodiscard]] Proven of_vertex_over(int vertex_side, const Vec3& p, std::uint32_t face) const {
    const ConvexMesh& mesh = *meshes_[1 - vertex_side];
    const Corners c = corners(1 - vertex_side, face);
    const std::array<Vec3, 3> sides{c[1] - c[0], c[2] - c[1], c[0] - c[2]};
    const Vec3 n = mesh.outward * cross(sides[0], sides[1]), to = p - c[0];
    const double length = norm(n), height = dot(n, to) / length;
    if (!(height > -4 * rounding_)) return Proven::nothing;
    double lateral = size_, longest = 0;
    for (int k = 0; k < 3; ++k) {
      const double side = norm(sides[k]);
      longest = std::max(longest, side);
      lateral = std::min(lateral, mesh.outward * dot(cross(n, sides[k]), p - c[k]) / (length * side));
    }
    const double u_error = 8 * rounding_ * longest / length;
    if (!(u_error < kReliable) || !(lateral > 0) || !aside(lateral, std::abs(height))) return Proven::nothing;
    if (!(lateral * mesh.inner_radius > 2 * kMany * rounding_ * mesh.size)) return Proven::nothing;
    const Vec3 u = ((vertex_side == 0 ? -1 : 1) / length) * n;
    if (!highest(vertex_side, u, u_error, lateral)) return Proven::nothing;
    return by_height(height, [&] { return mesh.outward * orientation(c[0], c[1], c[2], p); });
  }

  const std::array<const ConvexMesh*, 2> meshes_;
  const pairs::MeshPair& pair_;
  double scale_, rounding_, size_;
  Vec3 away_;  // from O2 to O1
  Feature features_[2];
  pairs::FacePair faces_{};
};

}  // namespace

ConvexPair::ConvexPair(const ConvexMesh& o1, const ConvexMesh& o2, const pairs::MeshPair& pair, double scale)
    : o1_(o1),
      o2_(o2),
      pair_(pair),
      scale_(scale),
      rounding_(kPosedRounding * (o1.lengths + scale * o2.lengths + norm(pair.pose.offset))) {}

bool ConvexPair::centres_near() const {
  const double reach = o1_.inner_radius + scale_ * o2_.inner_radius - kMany * rounding_;
  return reach > 0 && squared_norm(pair_.pose(o2_.centre) - o1_.centre) < reach * reach;
}

std::optional<pairs::Separation> ConvexPair::find_closest(double bound, Simplex& simplex,
                                                          pairs::FacePair& hint) {
  found_overlap_ = centres_near();
  if (found_overlap_) return {};
  const SupportRequest request{o1_, o2_, pair_.pose, scale_, bound, rounding_};
  const Relation relation = search_by_supports(request, simplex);
  if (relation == Relation::apart) return pairs::Separation{};
  found_overlap_ = relation == Relation::overlap;
  if (found_overlap_ || simplex.count == 0) return {};
  Proof proof({&o1_, &o2_}, pair_, scale_, rounding_, simplex);
  const Proven proven = proof.find();
  found_overlap_ = proven == Proven::intersecting;
  if (found_overlap_) return {};
  hint = proof.faces();
  if (proven == Proven::nothing) return {};
  const PointPair points = proof.points_of_features();
  const double distance = std::sqrt(points.squared);
  if (distance > bound) return pairs::Separation{};
  return pairs::Separation{distance, false, points.point1, points.point2, hint[0], hint[1]};
}

std::optional<bool> ConvexPair::colliding(Simplex& simplex) {
  if (centres_near()) return true;
  const SupportRequest request{o1_, o2_, pair_.pose, scale_, 0, rounding_};
  const Relation relation = search_by_supports(request, simplex);
  if (relation == Relation::apart) return false;
  if (relation == Relation::overlap) return true;
  if (simplex.count == 0) return {};
  const Proven proven = Proof({&o1_, &o2_}, pair_, scale_, rounding_, simplex).find();
  if (proven != Proven::nothing) return proven == Proven::intersecting;
  return touching(o1_, o2_, pair_, scale_, simplex, kMany * rounding_);
}

}  // namespace sdm::convex
