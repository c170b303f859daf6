// The contacts of two bodies of which one at least is no mesh, or has a margin.
#pragma once

#include <sdm/proximity_query.h>

#include <span>
#include <vector>

#include "bodies/contacts/contact_patches.h"
#include "bodies/solids/convex_patch.h"
#include "bodies/solids/mesh_distance.h"
#include "bodies/solids/solid_pair.h"

namespace sdm::solids {

/// Convex bodies, and a half-space and one of these, have the patch of their features across the normal; a
/// half-space and another mesh, the corners of the hull of its vertices in contact, seen along the normal,
/// and the deepest one. Of another mesh and a solid, the points of its faces that are closest to the core, or
/// to an end of it, among all points nearby. Reuses its memory.
class SolidContacts {
 public:
  /// Returns the contacts whose depth is at least minus the margin; the span is valid until the next call.
  [[nodiscard]] std::span<const Contact> find(const shape::PosedBody& o1, const shape::PosedBody& o2,
                                              const SolidPair& pair, const Relation& relation, double margin);

 private:
  void add_single(const shape::PosedBody& o1, const shape::PosedBody& o2, const Relation& relation);
  void add_hull_of_vertices(const shape::PosedBody& mesh, const PosedCore& space, int mesh_side,
                            double margin, double size);
  void add_closest_faces(const shape::PosedBody& mesh, const PosedCore& core, int mesh_side,
                         const Relation& relation, double margin, double size);
  void add_from(const PosedCore& at, std::uint64_t id, const shape::PosedBody& mesh, const PosedCore& core,
                int mesh_side, double margin, double size);
  void add(const Vec3& on_mesh, std::uint32_t face, const shape::PosedBody& mesh, const Vec3& on_solid,
           const Vec3& normal, double depth, int mesh_side, std::uint64_t id);

  ConvexPatch patch_;
  contacts::ContactOrder order_;
  std::vector<Contact> contacts_;
  std::vector<FaceDistance> near_;
};

}  // namespace sdm::solids
