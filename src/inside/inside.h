// Inside or outside of a mesh. All such tests go through this header: InsideTest for queries whose closest
// points are known, and contains(), which is exact, for a moved solid. SitesData::is_solid determines which
// meshes have an inside.
#pragma once

#include <sdm/sites.h>

#include <cstdint>
#include <span>

#include "inside/sign.h"
#include "sites/closest_packet.h"
#include "sites/sites_data.h"

namespace sdm::inside {

/// Tests whether points lie inside O2, by one method, for many queries.
///
/// For a solid: points with a winding number other than 0. No face lies between a query and its closest
/// point, so the pseudonormal of the closest site tells the side of the closest face on which the query lies
/// (Bærentzen & Aanæs 2005), and FaceSides whether that side is inside. Where other faces are too near, the
/// winding number is computed. A query in the clear ball of another one, which no face meets, has its answer.
class InsideTest {
 public:
  /// `method` as chosen by choose_sign; `none` makes every answer "outside". `error`: the closest points of
  /// packets are closest to within this length. Cost: constant, but for the first test of a shape.
  InsideTest(const sites::SitesData& sites, SignMethod method, double error = 0);
  /// Adapts to new positions of the sites.
  void refit();

  /// `closest` is the closest point of the query. The generalised winding number does without one. On the
  /// surface: outside.
  [[nodiscard]] bool operator()(const Vec3& query, const ClosestPoint& closest) const;
  /// The answer of operator(), faster where most queries are the only one at their closest face.
  [[nodiscard]] bool of_few(const Vec3& query, const ClosestPoint& closest) const;
  /// A bit mask of the queries that are inside, of at most kPacket. With `few`, as of_few().
  [[nodiscard]] std::uint32_t operator()(std::span<const Vec3> queries, std::span<const ClosestPoint> closest,
                                         bool few) const;
  /// A bit mask of the queries of a packet that are inside. Fastest if successive packets are near to each
  /// other.
  [[nodiscard]] std::uint32_t operator()(std::span<const Vec3> queries,
                                         const sites::ClosestPacket& closest) const;

  /// Whether the closest point of a query inside a solid lies on the boundary, to 1e-6 of the size of the
  /// solid. True for solids that do not intersect themselves. False also where this was not decided.
  [[nodiscard]] bool at_boundary(const Vec3& query, const ClosestPoint& closest) const;
  /// A point within 1e-6 of the size of a solid of one on its surface, and whether it is inside: outside,
  /// unless all that were tried are inside.
  struct Beside {
    Vec3 point{};
    bool inside = false;
  };
  [[nodiscard]] Beside beside(const Vec3& p) const;
  /// The sides of the faces of a solid.
  [[nodiscard]] const FaceSides& sides() const { return *sides_; }

 private:
  [[nodiscard]] bool inside_solid(const Vec3& query, const ClosestPoint& closest) const;
  /// The side of an open O2, as of SignMethod::side.
  [[nodiscard]] bool behind(const Vec3& query, const ClosestPoint& closest) const;
  /// The radius of a clear ball around a query: the surface does not meet it. 0 if none is known.
  [[nodiscard]] double clear_radius(SiteType type, double distance) const;
  /// Decides by known clear balls, or by test(clear radius), which returns a WindingNumber::Side; adds a
  /// ball. `type` and `distance` are those of the closest point.
  template <class Test>
  [[nodiscard]] bool inside_ball(const Vec3& query, SiteType type, double distance, const Test& test) const;
  [[nodiscard]] bool test(const Vec3& query, const ClosestPoint& closest, bool few) const;
  [[nodiscard]] bool dense_test(const Vec3& query, const ClosestPoint& closest) const;
  /// Decides by the winding number.
  [[nodiscard]] WindingNumber::Side above_half(const Vec3& query, const ClosestPoint& closest, bool few,
                                               double clear) const;
  /// Decides by winding numbers; closest(i) is the closest point of query i. The queries are searched
  /// together if none is farther from the surface than `widest` times the size of the packet: balls take less
  /// time if they contain it.
  template <class Closest>
  [[nodiscard]] std::uint32_t above_half(std::span<const Vec3> queries, const Closest& closest, bool few,
                                         double widest) const;

  const sites::SitesData& sites_;
  SignMethod method_;
  double error_;
  const ShapeSigns* signs_ = nullptr;  ///< none without a method
  // Set as the method needs them:
  const FaceSides* sides_ = nullptr;
  const WindingNumber* winding_ = nullptr;
  const BoundarySites* boundary_ = nullptr;
};

}  // namespace sdm::inside
