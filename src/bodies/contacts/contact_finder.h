// Contacts of two bodies, from their vertices and edges.
#pragma once

#include <sdm/proximity_query.h>

#include <array>
#include <span>
#include <vector>

#include "bodies/contacts/contact_patches.h"
#include "bodies/contacts/feature_contacts.h"

namespace sdm::contacts {

/// Finds contacts; reuses its memory between calls.
class ContactFinder {
 public:
  /// See ProximityQuery::contacts. `meshes`: of both, in the frame of O1. `to_other`: from the frame of each
  /// body to that of the other. `length`: below this length, the vector to the other body does not determine
  /// the normal, nor a difference of depths the order. Cost: of the pairs of faces within the margin, on two
  /// cores, and of a few closest points for each contact, on all.
  [[nodiscard]] std::span<const Contact> find(const Bodies& bodies, const pairs::MeshPair& meshes,
                                              const std::array<mesh::Similarity, 2>& to_other, double margin,
                                              double length);

 private:
  /// Features of one body: vertices of regions, or edges of leaves.
  struct Task {
    int side = 0;
    std::span<const ContactRegion> regions{};
    std::span<const std::uint32_t> leaves{};
  };
  void add_tasks(int side);

  pairs::NearFacesWorkspace near_workspace_;
  pairs::NearFaces near_;
  std::array<ContactCandidates, 2> candidates_;  ///< of each body
  std::vector<Task> tasks_;
  std::vector<FeatureContacts> found_;  ///< by each task
  std::vector<Contact> contacts_;
  std::vector<Box> boxes_;
  ContactPatches patches_;
};

}  // namespace sdm::contacts
