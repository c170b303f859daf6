// Contacts in patches: those whose places on the surface are connected.
#pragma once

#include <sdm/proximity_query.h>

#include <span>
#include <vector>

#include "core/disjoint_sets.h"
#include "core/geometry/sweep.h"

namespace sdm::sampled {

/// Sorts contacts, again and again in the same memory.
class ContactPatches {
 public:
  /// Numbers patches, of contacts whose boxes meet, one after the other: by their deepest contact, the
  /// deepest patch first. Returns the contacts patch by patch, in each by depth; valid until the next call.
  std::span<const Contact> sort(std::span<Contact> contacts, std::span<const Box> boxes);

 private:
  std::vector<Contact> sorted_;
  std::vector<std::uint32_t> order_;
  DisjointSets patches_;
  Sweep sweep_;
};

}  // namespace sdm::sampled
