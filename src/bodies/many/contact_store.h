// The contacts of all pairs of bodies, of one of their lists.
#pragma once

#include <sdm/proximity_query.h>

#include <cstddef>
#include <span>
#include <vector>

#include "bodies/many/near_pairs.h"

namespace sdm::bodies {

/// Contacts of pairs, which stay in their place while others are found again: a motion of few bodies costs
/// the contacts of few pairs. Reuses its memory.
class ContactStore {
 public:
  explicit ContactStore(ContactList list) : list_(static_cast<std::size_t>(list)) {}

  /// Before contacts of at most `pairs` pairs are found.
  void begin(std::size_t pairs) {
    if (found_.size() < pairs) found_.resize(pairs);
  }
  /// Keeps those of the u-th pair until they are stored. Concurrently for different pairs.
  void found(std::size_t u, std::span<const Contact> contacts) {
    found_[u].assign(contacts.begin(), contacts.end());
  }
  /// Stores those of near.list()[unknown[u]] for each u, and forgets those of pairs that are not near any
  /// more. If it throws, nothing has changed.
  void store(NearPairs& near, std::span<const std::size_t> unknown);

  /// Valid until the next call of store().
  [[nodiscard]] std::span<const Contact> of(const PairState& pair) const {
    const auto& [first, count] = pair.contacts[list_];
    return std::span(contacts_).subspan(first, count);
  }

 private:
  void keep_only_near(NearPairs& near);

  std::size_t list_;
  std::vector<std::vector<Contact>> found_;
  std::vector<Contact> contacts_, next_;  ///< with those of former pairs and poses between them
};

}  // namespace sdm::bodies
