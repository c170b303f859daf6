// Points of the input that the faces of a simplified mesh stand for.
#pragma once

#include <sdm/mesh.h>
#include <sdm/sites.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/point_triangle.h"
#include "simplify/collapsing_mesh.h"

namespace sdm::simplify {

/// The distance to a triangle, for many points.
struct NearTriangle : TriangleSides {
  using TriangleSides::TriangleSides;

  [[nodiscard]] bool is_over(const Vec3& p) const {
    Vec3 foot;
    return over(p, foot);
  }
  /// The squared distance, or any number ≥ `best` if it is not less.
  [[nodiscard]] double squared_distance(const Vec3& p, double best) const {
    const double height = dot(normal, p - corner[0]);
    const double above = height * height * inverse_normal;
    if (above >= best) return above;
    Vec3 foot;
    if (over(p, foot)) return above;
    double least = squared_norm(on_side(0, p) - p);
    least = std::min(least, squared_norm(on_side(1, p) - p));
    return std::min(least, squared_norm(on_side(2, p) - p));
  }
};

/// The vertices of the input, and points between them where faces are large, each with the face that carries
/// it: one of the mesh on the way that is near it.
class CarriedPoints {
 public:
  /// Each face of the input carries points of its own. Cost: linear.
  explicit CarriedPoints(const Mesh& input);
  /// Faces of a mesh with fewer of them carry the points that are closest to them. Cost: a search for each.
  CarriedPoints(const Mesh& input, const Sites& carriers);

  /// The root of the mean squared distance of all points to the faces that carried them at first.
  [[nodiscard]] double first_distance() const { return first_distance_; }

  /// The largest distance of the points of faces around an edge to the nearest of the faces that are to
  /// replace these; where one is larger than `enough`, others are left out. If it is larger than `allowed`,
  /// its point is the first one of its face from now on. Remembers what was found.
  [[nodiscard]] double measure(const CollapsingMesh& mesh, std::uint32_t u, std::uint32_t v,
                               std::span<const MovedFace> moved, double allowed, double enough);
  /// Gives the points of all these faces to what was found: no distance was larger than `enough`. Of faces
  /// with many points, every second one is dropped, unless it is among the farthest.
  void carry(const CollapsingMesh& mesh, std::uint32_t u, std::uint32_t v, std::span<const MovedFace> moved);

  /// A point of a moved face, and a face of the input that may be near it.
  struct Sample {
    Vec3 at;
    std::uint32_t moved;
    std::uint32_t near = kNone;
    double squared = kInfinity;
  };
  /// Sets the face near each sample to that of the point nearest to it, of those found with its moved face.
  /// The first sample of a moved face follows those of the one before.
  void find_near(std::span<Sample> samples);

 private:
  struct Farthest {
    double squared = 0;
    std::uint32_t face = kNone, before = kNone, point = kNone;  // before: in the list of the face
  };

  struct Found {
    std::uint32_t point, moved;
    double squared;  // the distance to the moved face that is nearest
  };

  void add(const Vec3& p, std::uint32_t face);
  void add_all(const Mesh& input, std::size_t carriers, double least_steps);
  void add_between(const Corners& corners, const Triangle& t, std::uint32_t face, double spacing,
                   double least_steps);

  std::vector<Vec3> points_;
  std::vector<std::uint32_t> source_;  // the face of the input
  std::vector<std::uint32_t> next_;    // of the same face
  std::vector<std::uint32_t> first_;   // of each face
  std::vector<NearTriangle> near_;
  std::vector<std::uint32_t> faces_;
  std::vector<Found> found_;
  double farthest_ = 0;  // of these, squared
  double first_distance_ = 0;
  std::vector<std::uint32_t> first_sample_, carried_;  // of each moved face
};

}  // namespace sdm::simplify
