#include "bodies/contacts/contact_candidates.h"

namespace sdm::contacts {

// Vertices are joined across the faces that are not near the other body.
void ContactCandidates::find(const ContactQuery& query) {
  query_ = query;
  const mesh::Similarity& to_other = query_.to_other[query_.side];
  regions_.find(query_.on(), query_.other(), to_other, query_.limit, *query_.near, query_.side);
  vertices_.start(query_.on(), query_.other(), to_other, query_.limit);
  const sites::Regions& sites = internals(query_.on().sites()).regions;
  for (const ContactRegion& region : regions()) {
    if (region.is_inside()) continue;
    for (std::uint32_t leaf = region.first_leaf; leaf < region.last_leaf; ++leaf) {
      const std::uint32_t near = near_faces(leaf), first = sites.leaves[leaf];
      for (std::uint32_t i = first; i < sites.leaves[leaf + 1]; ++i)
        vertices_.add_face(sites.places.corners[i], (near >> (i - first) & 1) != 0);
    }
  }
  vertices_.find_sides();
}

}  // namespace sdm::contacts
