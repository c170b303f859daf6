// Bounds on the depth of a surface inside a solid, part by part.
#pragma once

#include <cstdint>
#include <variant>
#include <vector>

#include "bodies/shape/node_ball.h"
#include "bodies/shape/posed_body.h"
#include "certify/depth/boundary.h"
#include "certify/depth/exit_directions.h"
#include "search/branch_and_bound.h"

namespace sdm::depth {

struct NodePart {
  std::uint32_t node = 0;  ///< of the wide tree, or a leaf
};

/// A face, or a part of one that dividing it into quarters results in.
struct TrianglePart {
  Corners at{};
  CornerValues weights{};           ///< of the corners, at the centre of the part
  std::uint64_t step = 0;           ///< of SurfacePart::place: its quarters are a quarter step apart
  RecentBounds bounds{};            ///< found for the triangle, or for those that it is part of
  double gap = 0;                   ///< between the bounds on the depth of the centre, in space
  double max_distance = kInfinity;  ///< from the centre to the surface
  std::size_t known = 0;            ///< number of parts of the boundary that it may be bounded by
  std::uint32_t measured = 0;       ///< how often
  bool stale = true;                ///< whether it is still to be bounded by all of `bounds`
};

/// A node or a triangle of the surface of a body, in the frame of the solid.
struct SurfacePart {
  int body = 0;             ///< whose surface it is part of
  std::uint64_t place = 0;  ///< in the order of the tree
  shape::Ball
      ball{};  ///< contains the part; measured is its centre: of a triangle, where its bound is attained
  double upper = kInfinity;  ///< bound on the depth of its points, in space
  std::size_t exits = 0;     ///< number of exit directions that it is bounded by
  std::variant<NodePart, TrianglePart> what{};

  void limit(double bound) { upper = std::min(upper, bound); }
};

/// The value at the centre of a part.
struct Value {
  BoundaryDistance b;  ///< 0 if it is outside
  RecentBounds bounds;
};

using Parts = search::Parts<SurfacePart, std::vector<Value>>;

/// A body that leaves a solid: for points p of its surface inside the solid, b(p) is the distance to the
/// boundary. A part is bounded by the value at the centre c of its ball, and the better of
///   b(p) ≤ b(c) + |p − c|, as the distance is 1-Lipschitz, and
///   b(p) ≤ max over the corners p of a triangle of |p − G|, for a boundary face G: the distance to a convex
///          set is convex; of a convex solid, the height of p below the plane of G instead.
/// The second one, with the G that is nearest to c, exceeds b(c) by the square of the size of a triangle
/// only, and not at all above one flat face. Where several faces are nearly as close, as about the deepest
/// points, mixed_bound() of the distances to two of them and of the ExitDirections does so, too. A triangle
/// whose centre is outside has a similar bound. So the number of parts that must be divided hardly grows as
/// bounds are tightened. ExitDirections exclude most parts before anything is searched for them.
///
/// Points and lengths are in the frame of the solid; depths, those of parts and `enough`, are in space. What
/// is no deeper than `enough` does not matter.
class Leaving {
 public:
  /// Forgets all that was learned. The bodies must not change while this is used.
  void start(const shape::PosedBody& body, const shape::PosedBody& solid, const mesh::Similarity& to_solid);
  [[nodiscard]] const shape::Body& body() const { return *body_; }
  [[nodiscard]] const shape::Body& solid() const { return *solid_; }
  [[nodiscard]] const mesh::Similarity& to_solid() const { return to_solid_; }
  /// The factor from lengths in the frame of the solid to those in space.
  [[nodiscard]] double scale() const { return scale_; }
  [[nodiscard]] ExitDirections& exits() { return exits_; }

  void learn(const Vec3& from, const BoundaryPart& boundary) {
    if (boundary.clear == 0) known_.add(from, boundary);
  }
  /// Lowers the bound of a part by what has been learned since the last time. Returns whether there was
  /// anything.
  bool tighten(SurfacePart& part, double enough);
  /// Sets the value at the centre of a part, and lowers its bound by that. Thread-safe.
  void evaluate(SurfacePart& part, Value& value, const ClosestPoint& closest, bool inside,
                double enough) const;
  /// Finds whether the walls of the solid are thin. If so, evaluate() bounds parts by their thickness, too: a
  /// search that has measured many parts starts anew after this.
  void look_at_walls(double enough);
  /// Whether no point is deeper than that in most of the walls of the solid, and it is little for its size.
  [[nodiscard]] bool has_walls(double enough) const { return walls_within(enough, 1); }
  [[nodiscard]] bool thin() const { return thin_; }
  /// Puts the pieces of a part, or settles them.
  void divide(const SurfacePart& part, Parts& parts) const;

 private:
  /// Bounds on b at the corners of a triangle by two parts of the boundary, each convex in the triangle.
  [[nodiscard]] std::array<CornerValues, 2> bounds_by(const Corners& at,
                                                      const std::array<BoundaryPart, 2>& boundary) const;
  void evaluate_beside(SurfacePart& part, Value& value, const Vec3& step) const;
  [[nodiscard]] double bound_outside(const SurfacePart& part, const TrianglePart& triangle,
                                     const Value& value, double distance, const Vec3& step,
                                     double enough) const;
  [[nodiscard]] bool walls_within(double enough, double times) const;
  [[nodiscard]] bool walls_are_thin(const shape::Ball& ball, double enough) const;
  void bound_by_walls(SurfacePart& part, const ClosestPoint& closest, const BoundaryDistance& b, bool inside,
                      double enough) const;
  void put_children(const SurfacePart& part, std::uint32_t node, Parts& parts) const;
  void put_faces(const SurfacePart& part, std::uint32_t leaf, Parts& parts) const;
  void put_quarters(const SurfacePart& part, const TrianglePart& triangle, Parts& parts) const;
  void put_triangle(const SurfacePart& parent, std::uint64_t place, const TrianglePart& triangle,
                    Parts& parts) const;

  const shape::Body *body_ = nullptr, *solid_ = nullptr;
  mesh::Similarity to_solid_;
  double scale_ = 1;
  bool thin_ = false;    // walls
  bool convex_ = false;  // the solid
  ExitDirections exits_;
  KnownBoundary known_;
  std::vector<CornerValues> functions_;  // that bound b in a triangle
};

}  // namespace sdm::depth
