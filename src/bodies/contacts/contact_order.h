// The order of contacts, which small motions do not change.
#pragma once

#include <sdm/proximity_query.h>

#include <cstdint>
#include <vector>

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

}  // namespace sdm::contacts
