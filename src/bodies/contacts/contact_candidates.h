// The regions, vertices and faces of a body that may be in contact with another one.
#pragma once

#include <array>
#include <span>

#include "bodies/contacts/contact_regions.h"
#include "bodies/contacts/one_sided.h"
#include "bodies/pairs/near_faces.h"
#include "bodies/shape/posed_body.h"
#include "mesh/similarity.h"

namespace sdm::contacts {

using Bodies = std::array<const shape::PosedBody*, 2>;

/// The parameters of a call of ContactFinder::find(), for the features of one body. Spans and pointers are
/// valid for that call.
struct ContactQuery {
  Bodies bodies{};
  std::array<mesh::Similarity, 2> to_other{};
  int side = 0;      ///< the features are those of bodies[side]
  double limit = 0;  ///< the margin, in the frame of the other body
  double length = 0;
  double size = 0;                         ///< of the smaller body, in the frame of the other one
  const pairs::NearFaces* near = nullptr;  ///< with sorted leaves

  [[nodiscard]] const shape::Body& on() const { return bodies[side]->body(); }
  [[nodiscard]] const shape::Body& other() const { return bodies[1 - side]->body(); }
};

/// Finds the regions and the edges that may be in contact. Memory is reused between calls.
class ContactCandidates {
 public:
  /// Cost: of a closest point for each region, and for each set of vertices on one side.
  void find(const ContactQuery& query);

  [[nodiscard]] const ContactQuery& query() const { return query_; }
  [[nodiscard]] std::span<const ContactRegion> regions() const { return regions_.regions(); }
  /// Leaves with near faces.
  [[nodiscard]] std::span<const std::uint32_t> leaves() const { return query_.near->leaves[query_.side]; }
  /// Which faces of a leaf are near, as bits.
  [[nodiscard]] std::uint32_t near_faces(std::uint32_t leaf) const {
    return query_.near->of_leaf[query_.side][leaf];
  }
  /// The vertices of the regions that are not inside as a whole. Threads may query them at once.
  [[nodiscard]] OneSidedVertices& vertices() { return vertices_; }

 private:
  ContactQuery query_;
  ContactRegions regions_;
  OneSidedVertices vertices_;
};

}  // namespace sdm::contacts
