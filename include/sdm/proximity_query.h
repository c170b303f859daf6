/// Proximity of two bodies: separation, collision, penetration depth and contacts, each with its bounds.
#pragma once

#include <sdm/map.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

namespace sdm {

/// What a number is worth.
enum class Certainty {
  exact,    ///< the truth, to 1e-6 of the diagonal of both bodies' box
  bounded,  ///< the truth lies between the bounds given
  estimate  ///< a good guess, with no such promise
};

/// A length.
struct BoundedLength {
  double value = 0;
  Certainty kind = Certainty::bounded;
  double lower = 0, upper = 0;  ///< lower ≤ truth ≤ upper, unless an estimate
  /// A point of O1 and one of O2 that are `value` apart; nothing where the value stands for no two points.
  std::optional<std::array<Vec3, 2>> witness{};
};

struct BoundedBool {
  bool value = false;
  Certainty kind = Certainty::estimate;
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
  /// Contacts are of all that is inside the other body or as near to it as this; ≥ 0, in units of the meshes.
  double contact_margin = 0;
};

/// The proximity of two bodies that deform: for simulation loops.
///
/// A body that is closed and orientable is solid; of another there is only the surface. Distances are
/// measured at the samples of both bodies' atlases, but only there where they can matter. By the covering
/// radii R of the samples (Surface::sample_radii) and because distances are 1-Lipschitz, they bound the
/// distance everywhere:
///     min (d − R) ≤ separation ≤ min d,    max (−d) ≤ penetration depth ≤ max (R − d).
class ProximityQuery {
 public:
  /// Throws sdm::Error as Surface and Sites do, and for a margin that is negative or not finite. Cost: both
  /// bodies' atlases and sites.
  ProximityQuery(Mesh o1, Mesh o2, const ProximityOptions& options = {});
  ~ProximityQuery();
  ProximityQuery(ProximityQuery&&) noexcept;
  ProximityQuery& operator=(ProximityQuery&&) noexcept;

  /// Moves the vertices of the bodies, keeping their triangles: for others, make a new Query. No positions: a
  /// body stays. Throws sdm::Error, and changes nothing, for a wrong count or a coordinate that is not
  /// finite. Cost: linear. Neither this nor the answers take memory once the bodies have been through such
  /// poses.
  void update(std::span<const Vec3> o1, std::span<const Vec3> o2);

  // Answers are computed when they are first asked for after an update.

  /// The least distance of the two surfaces; 0 where they intersect.
  [[nodiscard]] const BoundedLength& separation();
  /// Whether the surfaces intersect, or one body is solid and holds a part of the other.
  [[nodiscard]] BoundedBool colliding();
  /// The largest distance to the surface of a body, of all points of the other body's surface that lie inside
  /// of it. Nothing if neither body is solid.
  [[nodiscard]] const std::optional<BoundedLength>& penetration_depth();
  /// From both bodies: each small part of the surface (256 samples that are neighbours, those of one chart)
  /// with samples inside the other body, or within the margin, has a contact at the deepest. Patch by patch,
  /// the deepest first, and so in each. Parts whose boxes, grown by what the samples cover, meet are of one
  /// patch: a connected region of contact is never cut.
  [[nodiscard]] std::span<const Contact> contacts();

  /// O1 for 0, O2 for 1.
  [[nodiscard]] const Surface& surface(int body) const;
  [[nodiscard]] const Sites& sites(int body) const;
  /// Samples of both bodies that the last answers took: the others cannot matter.
  [[nodiscard]] std::size_t samples_used() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sdm
