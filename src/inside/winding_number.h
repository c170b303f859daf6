// The generalised winding number of a triangle soup.
#pragma once

#include <sdm/types.h>

#include <optional>
#include <span>
#include <vector>

#include "core/lazy/kept.h"
#include "inside/angles/packet_angles.h"
#include "inside/angles/solid_angles.h"
#include "inside/open_sides.h"
#include "sites/sites_data.h"

namespace sdm::inside {

/// How many times the mesh winds around a point (Jacobson, Kavan & Sorkine 2013): 1 inside and 0 outside a
/// closed mesh, in between around an open one.
///
/// The faces of the mesh and those that close it (open_sides.h) have a winding number that is an integer,
/// and follows from the crossings of a segment, exactly. What remains is the solid angle of the closing
/// faces: of few where boundaries are short, and of those near to the point at that. Where they would be more
/// than half as many as the faces of the mesh, and where rounding leaves open on which side of them a point
/// is, the solid angles of the mesh are summed instead.
class WindingNumber {
 public:
  explicit WindingNumber(const sites::SitesData& sites);
  WindingNumber(const WindingNumber&) = delete;
  WindingNumber& operator=(const WindingNumber&) = delete;

  /// The winding number around q, which does not lie on the mesh, to within `error` and rounding. Cost:
  /// logarithmic for large errors, at worst linear for 0.
  [[nodiscard]] double operator()(const Vec3& q, double error) const;

  struct Side {
    bool above = false;  ///< whether the winding number is above 1/2
    /// The answer holds for all points nearer to q than this, as far as a straight line leads to them without
    /// meeting the mesh.
    double safe_radius = 0;
  };
  /// The side of 1/2 on which the winding number around q is.
  [[nodiscard]] Side above_half(const Vec3& q) const;
  /// above_half(q), faster where the number beside the closest site is known. `few`: most queries are the
  /// only one at their closest face. `clear`: no face is nearer; tries to decide all points nearer than this,
  /// so that the safe radius is at least `clear`.
  [[nodiscard]] Side above_half(const Vec3& q, const ClosestPoint& closest, bool few, double clear = 0) const;
  /// above_half() of points near each other, at most kPacket, as far as one search of the tree decides it.
  [[nodiscard]] PacketSides above_half(std::span<const Vec3> points, std::span<const ClosestPoint> closest,
                                       bool few) const;

  /// Whether sums have many faces. With few, safe radii are large, and packets save nothing far from the
  /// mesh.
  [[nodiscard]] bool sums_many_faces() const {
    constexpr std::size_t kMany = 2000;
    return !closing_.angles || closing_.triangles.size() >= kMany;
  }

 private:
  /// The closing faces.
  struct Closing {
    std::vector<Triangle> triangles;
    tree::AabbTree tree;
    tree::WideTree wide;
    std::optional<SolidAngles> angles;
  };

  void build_closing(std::vector<Triangle> triangles);
  [[nodiscard]] OrientedFaces closing_faces() const;
  /// The number of the closed surface; empty where no segment decides it.
  [[nodiscard]] std::optional<int> closed(const Vec3& q) const;
  [[nodiscard]] std::optional<int> closed(const Vec3& q, const ClosestPoint& closest, bool few) const;
  /// Decides with the number of the closed surface.
  [[nodiscard]] Side above_half(const Vec3& q, std::optional<int> closed) const;
  /// above_half() in single precision; empty where that does not decide it.
  [[nodiscard]] std::optional<Side> coarse_side(const Vec3& q, std::optional<int> closed, double clear) const;
  [[nodiscard]] const SolidAngles& mesh_angles() const;

  const sites::SitesData& sites_;
  Closing closing_;
  std::optional<OpenSides> sides_;  ///< if there are closing faces
  Kept<SolidAngles> mesh_angles_;
};

}  // namespace sdm::inside
