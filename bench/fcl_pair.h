// Two meshes as FCL's bounding-volume hierarchies of oriented boxes and swept spheres.
#pragma once

#include <sdm/mesh.h>

#include <memory>

#include "core/affine.h"

namespace sdm::bench {

/// FCL's results for two meshes, the second moved by a rigid pose.
class FclPair {
 public:
  FclPair(const Mesh& o1, const Mesh& o2);
  ~FclPair();

  /// The distance of the surfaces, with closest points; -1 or 0 where they intersect.
  [[nodiscard]] double distance(const Affine& pose) const;
  /// Whether the surfaces intersect; the first contact ends the search.
  [[nodiscard]] bool collide(const Affine& pose) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sdm::bench
