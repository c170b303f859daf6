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
  exact,    ///< accurate to 1e-6 of the diagonal of both bodies' box
  bounded,  ///< the true value lies between the given bounds
  estimate  ///< no guarantee
};

/// A length.
struct BoundedLength {
  double value = 0;
  Certainty certainty = Certainty::bounded;
  double lower = 0, upper = 0;  ///< lower ≤ truth ≤ upper, unless an estimate
  /// A point of O1 and a point of O2 that are `value` apart; empty where no pair of points attains the value.
  std::optional<std::array<Vec3, 2>> witness{};
};

struct BoundedBool {
  bool value = false;
  Certainty certainty = Certainty::estimate;
};

/// A point of one body and the point of the other's surface that is closest to it.
struct Contact {
  Vec3 point1{}, point2{};  ///< on O1 and on O2
  /// Unit vector along which O1 is pushed off O2: (point2 − point1) / depth, whichever sign depth has; where
  /// that is 0, O2's outward pseudonormal. For the two bodies swapped it is the opposite.
  Vec3 normal{};
  double depth = 0;  ///< |point2 − point1|, positive if the sampled point lies inside the other body: exact
  std::uint32_t patch = 0;  ///< contacts whose places on the surface are connected are of one patch
};

struct ProximityOptions {
  AtlasOptions atlas{.resolution = 512};  ///< of both bodies: its samples are where distances are measured
  /// Separation and collision from the triangles themselves; else from the samples, with their bounds.
  bool exact = false;
  /// Contacts are reported for everything inside the other body or within this distance of it; ≥ 0, in units
  /// of the meshes.
  double contact_margin = 0;
};

/// Proximity of two deforming bodies, for simulation loops.
///
/// A closed, orientable body is a solid; any other body is a surface without an inside. Distances are
/// measured at those samples of both bodies' atlases that can affect a result. By the covering
/// radii R of the samples (SamplingBound::sample_radii) and because distances are 1-Lipschitz, they bound the
/// distance everywhere:
///     min (d − R) ≤ separation ≤ min d,    max (−d) ≤ penetration depth ≤ max (R − d).
class SDM_API ProximityQuery {
 public:
  /// Throws sdm::Error as Surface and Sites do, and for a margin that is negative or not finite. Cost: both
  /// bodies' atlases and sites.
  ProximityQuery(Mesh o1, Mesh o2, const ProximityOptions& options = {});
  ~ProximityQuery();
  ProximityQuery(ProximityQuery&&) noexcept;
  ProximityQuery& operator=(ProximityQuery&&) noexcept;

  /// Moves the vertices of the bodies, keeping their triangles: for others, make a new Query. No positions: a
  /// body stays. Throws sdm::Error, and changes nothing, for a wrong count or a coordinate that is not
  /// finite. Cost: linear. Neither this nor the queries allocate memory once the bodies have been through
  /// similar poses.
  void refit(std::span<const Vec3> o1, std::span<const Vec3> o2);

  // Results are computed by the first call after a refit.

  /// The smallest distance between the two surfaces; 0 if they intersect.
  [[nodiscard]] const BoundedLength& separation();
  /// Whether the surfaces intersect or one body is a solid that contains part of the other.
  [[nodiscard]] BoundedBool colliding();
  /// The largest distance to the surface of a body, of all points of the other body's surface that lie inside
  /// of it. Nothing if neither body is solid.
  [[nodiscard]] const std::optional<BoundedLength>& penetration_depth();
  /// From both bodies: each small part of the surface (256 samples that are neighbours, those of one chart)
  /// with samples inside the other body, or within the margin, has a contact at the deepest. Patch by patch,
  /// the deepest first, and so in each. Parts whose boxes, grown by what the samples cover, meet are of one
  /// patch: a connected contact region is never divided.
  [[nodiscard]] std::span<const Contact> contacts();

  /// O1 for 0, O2 for 1.
  [[nodiscard]] const Surface& surface(int body) const;
  [[nodiscard]] const Sites& sites(int body) const;
  /// The number of samples of both bodies measured for the last results; the others cannot affect them.
  [[nodiscard]] std::size_t samples_used() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sdm
