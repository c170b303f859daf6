// Groups contacts into contact patches: those connected on the surface.
#pragma once

#include <sdm/proximity_query.h>

#include <cstdint>
#include <span>
#include <vector>

#include "core/disjoint_sets.h"
#include "geometry/boxes.h"

namespace sdm::contacts {

/// Sorts contacts; reuses its memory between calls.
class ContactOrder {
 public:
  /// Sorts contacts by patch, that with the deepest contact first, and by depth, the deepest first, and
  /// numbers the patches so. Depths that differ by no more than `same` are one: their order is that of the
  /// ids, so that rounding and the last motions of a body at rest do not change it.
  void sort(std::vector<Contact>& contacts, double same);

 private:
  std::vector<std::uint32_t> order_, number_;
  std::vector<std::uint32_t> place_;  // of the next contact of each patch
  std::vector<Contact> sorted_;
};

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
