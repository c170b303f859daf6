/// Proximity of two bodies: separation, collision, penetration depth and contacts, each with its bounds.
#pragma once

#include <sdm/api.h>
#include <sdm/map.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

namespace sdm {

/// How reliable a number is.
enum class Certainty {
  exact,    ///< from the triangles, accurate to 1e-6 of the diagonal of both bodies' box
  bounded,  ///< the true value lies between the given bounds
  estimate  ///< no guarantee; no query returns it
};

/// A length with its bounds.
struct BoundedLength {
  double value = 0;
  Certainty certainty = Certainty::bounded;
  double lower = 0, upper = 0;  ///< lower ≤ truth ≤ upper, unless an estimate
  /// A point of O1 and a point of O2 that are `value` apart; empty where no pair of points attains the value.
  std::optional<std::array<Vec3, 2>> witness{};
};

/// A yes/no result with its certainty.
struct BoundedBool {
  bool value = false;
  Certainty certainty = Certainty::estimate;
};

/// A sampled point of one body and a closest point of the other: outside, the closest point of its surface;
/// inside, of the boundary of the solid, as far as it was found (see ProximityQuery::contacts).
struct Contact {
  Vec3 point1{}, point2{};  ///< on O1 and on O2
  /// Unit vector along which moving O1 separates it from O2: (point2 − point1) / depth, for depth of either
  /// sign; where depth is 0, O2's outward pseudonormal. Swapping the two bodies negates it.
  Vec3 normal{};
  double depth = 0;  ///< ±|point2 − point1|, exact; positive if the sampled point is inside the other body
  std::uint32_t patch = 0;  ///< contact patch: contacts on connected parts of the surface share one
};

struct ProximityOptions {
  AtlasOptions atlas{.resolution = 512};  ///< of both bodies; distances are measured at its samples
  /// Compute separation from the triangles; otherwise from the samples, with bounds. Collision is always
  /// computed from the triangles.
  bool exact = false;
  /// Contacts are reported for samples inside the other body or within this distance of it; ≥ 0, in units of
  /// the meshes.
  double contact_margin = 0;
};

/// Proximity of two deforming bodies, for simulation loops.
///
/// A closed, orientable body is a solid, with the inside of SignMethod::exact; any other body is a surface
/// without an inside. Distances are measured at those samples of both bodies' atlases that can affect a
/// result. As distances are 1-Lipschitz, they and the covering radii R of the samples
/// (SamplingBound::sample_radii) bound the distance everywhere:
///     min (|d| − R) ≤ separation ≤ min |d|,    max (−d) ≤ penetration depth ≤ max (R − d).
/// d is negative inside a solid; for the depth it is there the distance to the boundary of the solid: the
/// parts of its surface that have the inside on one side only. Where the solid intersects itself, that
/// distance has bounds of its own.
class SDM_API ProximityQuery {
 public:
  /// Throws sdm::Error as Surface and Sites do, and for a margin that is negative or not finite. Cost: that
  /// of the atlases and sites of both bodies.
  ProximityQuery(const Mesh& o1, const Mesh& o2, const ProximityOptions& options = {});
  ~ProximityQuery();
  ProximityQuery(ProximityQuery&&) noexcept;
  ProximityQuery& operator=(ProximityQuery&&) noexcept;

  /// Moves the vertices of the bodies, keeping their triangles; other triangles need a new ProximityQuery. An
  /// empty span leaves a body unchanged. Throws sdm::Error, and changes nothing, for a wrong number of
  /// positions or a coordinate that is not finite. Cost: that of Sites::refit. Neither this nor the queries
  /// allocate memory once the bodies have been through similar poses, unless a solid intersects itself.
  void refit(std::span<const Vec3> o1, std::span<const Vec3> o2);

  // Results are computed by the first call after a refit.

  /// The smallest distance between the two surfaces; exactly 0 if they intersect.
  [[nodiscard]] const BoundedLength& separation();
  /// Whether the surfaces intersect or one body is a solid that contains part of the other. Always exact,
  /// from the triangles.
  [[nodiscard]] BoundedBool colliding();
  /// The largest distance from a surface point of either body that lies inside the other to the boundary of
  /// that other body. Exactly 0 if they do not collide, otherwise bounded. Empty if neither body is a solid.
  [[nodiscard]] const std::optional<BoundedLength>& penetration_depth();
  /// The contacts of both bodies. The samples of each chart in each block (256 consecutive samples) that lie
  /// inside the other body or within the margin have one contact, at the one with the least signed distance
  /// to the surface of the other body. If that body intersects itself, the contact is with a point of its
  /// boundary, closest to about 1/1000 of its size, or else with the closest point of its surface. Sorted by
  /// patch, the patch with the deepest contact first, and by decreasing depth within a patch. Contacts belong
  /// to the same patch if the boxes of their samples, grown by the covering radii, intersect: a connected
  /// contact region is never divided.
  [[nodiscard]] std::span<const Contact> contacts();

  /// O1 for 0, O2 for 1.
  [[nodiscard]] const Surface& surface(int body) const;
  [[nodiscard]] const Sites& sites(int body) const;
  /// The number of samples of both bodies that the last results were measured at; no other sample can affect
  /// them.
  [[nodiscard]] std::size_t samples_used() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sdm
