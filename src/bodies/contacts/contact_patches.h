// Groups contacts into contact patches: those connected on the surface.
#pragma once

#include <sdm/proximity_query.h>

#include <span>
#include <vector>

#include "core/disjoint_sets.h"
#include "geometry/boxes/box_groups.h"

namespace sdm::contacts {

/// Sorts contacts; reuses its memory between calls.
class ContactPatches {
 public:
  /// Numbers the patches. Contacts whose boxes meet, directly or through others, are in one patch; patches
  /// are in the order of their deepest contacts, deepest first. Returns the contacts by patch, and by depth
  /// within a patch; valid until the next call. Boxes beyond those of the contacts connect contacts only.
  std::span<const Contact> sort(std::span<Contact> contacts, std::span<const Box> boxes);

 private:
  std::vector<Contact> sorted_;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint32_t> patch_of_;  ///< of the representative of a set of boxes
  DisjointSets patches_;
  BoxGroups groups_;
};

}  // namespace sdm::contacts
