// The penetration depth of two bodies, from their triangles.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "certify/depth/exit_directions.h"
#include "geometry/triangle_pair.h"
#include "query/shape/posed_body.h"

namespace sdm::depth {

/// Bounds on a depth, in space.
struct Depth {
  double lower = 0, upper = 0;
  double value = 0;  ///< that of `points`, if any: a point of O1 and one of O2
  std::optional<std::array<Vec3, 2>> points{};
};

/// Finds the largest distance b(p) from a point p of either surface inside the other body to the boundary of
/// that body, by branch and bound. Parts of a surface, at first the nodes of its tree, then its triangles and
/// their quarters, are bounded by the value at their centre c, and the better of
///   b(p) ≤ b(c) + |p − c|, as the distance is 1-Lipschitz, and
///   b(p) ≤ max over the corners p of a triangle of |p − G|, for a boundary face G: the distance to a convex
///          set is convex.
/// The second one, with the G that is nearest to c, exceeds b(c) by the square of the size of a triangle
/// only, and not at all above one flat face. Where several faces are nearly as close, as about the deepest
/// points, mixed_bound() of the distances to two of them and of the ExitDirections does so, too. A triangle
/// whose centre is outside has a similar bound. So the number of parts that must be divided hardly grows as
/// bounds are tightened. ExitDirections exclude most parts before anything is searched for them.
class DepthSearch {
 public:
  using Bodies = std::array<const shape::PosedBody*, 2>;

  /// Divides parts until the bounds are at most `precision` apart, in space, as far as those on the distance
  /// to the boundary of a solid that intersects itself are. Distances are computed to about 1e-6 of the size
  /// of both bodies, which is not part of the bounds. Cost: some thirty searches for the closest point, more
  /// where surfaces are nearly parallel; all cores if there are many. Reuses its memory.
  [[nodiscard]] Depth find(const Bodies& bodies, const std::array<mesh::Similarity, 2>& to_other,
                           double precision);

 private:
  static constexpr std::size_t kMostNear = 4;

  /// A face that is boundary on one side everywhere, or a point of the boundary. If `clear` > 0, the centre
  /// of a ball of that radius outside the solid: ways from it to points inside leave the ball first.
  struct BoundaryPart {
    std::uint32_t face = kNone;
    Vec3 point{};
    double clear = 0;
  };
  /// A part of the boundary, and the bounds that it gives at the corners of a triangle.
  struct Near {
    BoundaryPart boundary;
    CornerValues distance{};
  };
  /// Part of a surface, in the frame of the other body.
  struct Part {
    int body = 0;
    std::uint32_t node = kNone;  ///< of the wide tree, or a leaf; kNone: a triangle
    Corners at{};
    std::uint64_t place = 0, step = 0;  ///< in the order of the tree; its quarters are a quarter step apart
    Vec3 centre{};                      ///< where it is measured: of a triangle, where its bound is attained
    CornerValues weights{};             ///< of the corners of a triangle there
    double radius = 0;                  ///< of a ball about the centre that contains the part
    double upper = std::numeric_limits<double>::infinity();  ///< bound on b in the part, in space
    std::uint32_t near = 0, nears = 0;  ///< of nears_: found for the triangle, or those that it is part of
    double gap = 0;                     ///< between the bounds on b(c)
    double reach = std::numeric_limits<double>::infinity();  ///< the surface is no farther from the centre
    std::uint32_t known = 0;     ///< the number of parts of the boundary that it may be bounded by
    std::size_t exits = 0;       ///< the number of exit directions that it is bounded by
    std::uint32_t measured = 0;  ///< how often
    bool stale = true;           ///< whether it is still to be bounded by all of `near`
  };
  /// A point, and a part of the boundary near it.
  struct Known {
    Vec3 from{};
    BoundaryPart near;
  };
  struct Open {
    double upper = 0;
    std::uint32_t part = 0;
  };
  /// A point that is inside, and bounds on its distance to the boundary, in the frame of the other body.
  struct Value {
    double lower = 0, value = 0;
    std::optional<Vec3> boundary{};
    std::array<Near, 2> near{};
    std::size_t nears = 0;
  };

  void find_exits(int body);
  void take_deepest();
  void add_children(const Part& parent);
  void add_faces(const Part& parent);
  void add_triangle(Part part, const Part& parent);
  void add(const Part& part);
  void settle(double upper) { settled_ = std::max(settled_, upper); }
  void divide(const Part& part);
  void evaluate(std::size_t begin, std::size_t end);
  void evaluate(Part& part, Value& value) const;
  void evaluate(Part& part, Value& value, double distance, bool inside, const ClosestPoint& closest) const;
  [[nodiscard]] bool improve(const Part& part, const Value& value);
  [[nodiscard]] bool up_to_date(const Part& part) const;
  void tighten(Part& part);
  [[nodiscard]] bool find_near(const Part& part);
  void add_distances(const Part& part);
  void learn(const Part& part, const Value& value);
  [[nodiscard]] std::array<double, 4> distances(const std::array<Vec3, 4>& points, int body,
                                                const BoundaryPart& boundary) const;
  [[nodiscard]] Near near_at(const Part& part, const BoundaryPart& boundary) const;
  void add_near(Part& part, const Near& near);
  [[nodiscard]] std::span<const Near> near(const Part& part) const {
    return std::span(nears_).subspan(part.near, part.nears);
  }
  void place(Part& part, const CornerValues& weights) const;
  [[nodiscard]] bool cut(const Part& part, const Value& value) const;
  [[nodiscard]] double bound_outside(const Part& part, const Value& value, double distance) const;
  [[nodiscard]] double unit(int body) const { return bodies_[1 - body]->pose().scale; }

  Bodies bodies_{};
  std::array<mesh::Similarity, 2> to_other_;
  std::array<ExitDirections, 2> exits_;  // by the body that leaves the other
  std::array<std::vector<Known>, 2> known_;
  std::vector<Near> nears_;
  std::array<BoundaryPart, 2> near_;     // to the part that is bounded
  std::vector<CornerValues> functions_;  // that bound b in it
  double precision_ = 0, coarse_ = 0;
  Depth depth_;
  double sure_ = 0;            // what is no deeper than this does not matter
  double settled_ = 0;         // the largest bound of a part that does not matter
  std::vector<Open> open_;     // a heap, the deepest bound on top
  std::vector<Part> all_;      // that were ever open
  std::vector<Part> parts_;    // taken from the heap
  std::vector<Value> values_;  // of parts_
};

}  // namespace sdm::depth
