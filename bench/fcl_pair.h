// Two meshes as FCL's bounding-volume hierarchies of oriented boxes and rectangle-swept spheres.
#pragma once

#include <sdm/mesh.h>

#include <memory>

#include "geometry/affine.h"

namespace sdm::bench {

/// Distance and collision of two meshes by FCL, the second moved by a rigid pose.
class FclPair {
 public:
  FclPair(const Mesh& o1, const Mesh& o2);
  ~FclPair();

  /// The distance between the surfaces, computed with closest points; -1 or 0 where they intersect.
  [[nodiscard]] double distance(const Affine& pose) const;
  /// Whether the surfaces intersect; the search ends at the first contact.
  [[nodiscard]] bool collide(const Affine& pose) const;

  struct Contacts {
    std::size_t count = 0;  ///< points at which triangles intersect
    Vec3 deepest_normal{};  ///< of the one with the largest depth, from O1 to O2
    double deepest = 0;
  };
  /// All contacts: those of every pair of triangles that intersect.
  [[nodiscard]] Contacts contacts(const Affine& pose) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sdm::bench
