// Contacts inside a surface that others continue: at edges between faces in a plane, and between bodies that
// are fixed side by side.
#pragma once

#include <sdm/proximity_query.h>

#include <cstdint>
#include <span>
#include <vector>

#include "proximity/bodies/near_pairs.h"
#include "query/shape/posed_body.h"

namespace sdm::bodies {

/// Tells which contacts are internal. A point of a surface can only push along the normals of the faces
/// around it: where these are flat or concave, or continue in another body, a contact in another direction is
/// one with an edge that a body slides across.
class InternalContacts {
 public:
  /// For the bodies in their poses, until one moves. Cost: a sweep over the fixed bodies. Reuses memory.
  void follow(std::span<const shape::PosedBody> bodies, const PairFilter& filter);

  [[nodiscard]] bool contains(const Contact& contact, const Sweep::Pair& pair);

 private:
  /// A point of a body and the direction out of it, in the frame of its mesh.
  struct Exit {
    Vec3 point{}, direction{};
  };

  void find_faces(const sites::SitesData& sites, const SurfacePoint& point);
  [[nodiscard]] bool off_flat_faces(const shape::PosedBody& body, const Exit& exit) const;
  [[nodiscard]] bool into_neighbour(std::uint32_t body, const Exit& exit) const;
  [[nodiscard]] bool covered(std::uint32_t body, std::uint32_t face, const Vec3& point) const;
  [[nodiscard]] std::span<const Sweep::Pair> neighbours(std::uint32_t body) const;

  std::span<const shape::PosedBody> bodies_;
  std::vector<std::uint32_t> fixed_;
  std::vector<Box> boxes_;  ///< of these
  Sweep sweep_;
  std::vector<Sweep::Pair> neighbours_;  ///< a fixed body and another one beside it, sorted
  // Around the point that is looked at:
  std::vector<std::uint32_t> faces_;
  bool flat_ = false;  ///< it is on an edge or a vertex without a convex edge
};

}  // namespace sdm::bodies
