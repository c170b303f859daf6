/// Proximity of a mesh to itself: separation and contacts of a surface that folds.
///
/// Threads: an object is used by one thread at a time; different objects may be used concurrently.
#pragma once

#include <sdm/bounds.h>
#include <sdm/measure.h>
#include <sdm/mesh.h>
#include <sdm/proximity_query.h>
#include <sdm/sites.h>
#include <sdm/types.h>

#include <memory>
#include <optional>
#include <span>

namespace sdm {

/// Proximity of a deforming mesh to itself, for simulation loops. Results are exact: computed from the
/// triangles, without sampling error.
class SDM_API SelfProximityQuery {
 public:
  /// Throws sdm::Error as Sites and Exclusion do, and for a maximum distance out of range.
  explicit SelfProximityQuery(Mesh rest, const SelfProximityOptions& options = {});
  ~SelfProximityQuery();
  SelfProximityQuery(SelfProximityQuery&&) noexcept;
  SelfProximityQuery& operator=(SelfProximityQuery&&) noexcept;

  /// Moves the vertices; the excluded faces stay the same. Throws sdm::Error, and changes nothing, for a
  /// wrong number of positions or a coordinate that is not finite or beyond 1e37. If there is not enough
  /// memory, it also throws, and changes nothing or leaves the object broken (see sdm/error.h). Cost: linear.
  void refit(std::span<const Vec3> positions);

  /// The smallest distance between two faces that do not exclude each other, 0 if they intersect; exact.
  /// Empty if there are none within the maximum distance. The witness is a point on each of the two faces,
  /// the face of lower index first. Cost: one search per face, bounded by the smallest distance found so far;
  /// all cores.
  [[nodiscard]] std::optional<BoundedLength> separation();

  /// Each face within `margin`, in units of the mesh, of a face that it does not exclude has a contact with
  /// the nearest such face, at their closest points; two faces that are nearest to each other share one
  /// contact. point1 lies on the face of lower index. depth = −|point2 − point1|, as a surface has no inside;
  /// where it is 0, the normal is that of the second face. Contacts belong to the same patch if their boxes,
  /// each around its two faces, intersect. Sorted by patch, the nearest first, and by distance within a
  /// patch. Valid until the next call. Throws sdm::Error for a margin that is negative or not finite. Cost:
  /// one search per face, all cores, and sorting.
  [[nodiscard]] std::span<const Contact> contacts(double margin);

  /// The sites of the mesh in its present shape.
  [[nodiscard]] const Sites& sites() const;
  /// What is excluded, of the mesh at rest.
  [[nodiscard]] const Exclusion& exclusion() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sdm
