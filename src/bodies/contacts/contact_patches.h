// Groups contacts into contact patches: those connected on the surface.
#pragma once

#include <sdm/proximity_query.h>

#include <cstdint>
#include <span>
#include <vector>

#include "bodies/contacts/contact_order.h"
#include "core/disjoint_sets.h"
#include "geometry/boxes.h"

namespace sdm::contacts {

/// Sorts contacts; reuses its memory between calls.
class ContactPatches {
 public:
  /// Numbers the patches and sorts the contacts by ContactOrder. Contacts whose boxes meet, directly or
  /// through others, are in one patch. Boxes beyond those of the contacts connect contacts only.
  void sort(std::vector<Contact>& contacts, std::span<const Box> boxes, double same);

 private:
  ContactOrder order_;
  DisjointSets patches_;
  BoxGroups groups_;
};

}  // namespace sdm::contacts
