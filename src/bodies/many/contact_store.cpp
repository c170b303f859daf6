#include "bodies/many/contact_store.h"

#include <utility>

#include "core/memory.h"

namespace sdm::bodies {

void ContactStore::store(NearPairs& near, std::span<const std::size_t> unknown) {
  if (unknown.empty()) return;
  std::size_t count = 0;
  for (const NearPair& pair : near.list())
    if (pair.touching[list_]) count += near.state(pair).contacts[list_].count;
  std::size_t more = 0;
  for (std::size_t u = 0; u < unknown.size(); ++u) more += found_[u].size();
  // Contacts out of use are removed once they are half of all, which costs a constant time for each that was
  // added.
  const std::size_t most = 2 * (count + more);
  reserve_for(contacts_, most);
  reserve_for(next_, most);
  if (contacts_.size() + more > most) keep_only_near(near);
  for (std::size_t u = 0; u < unknown.size(); ++u) {
    NearPair& pair = near.list()[unknown[u]];
    pair.contacts_known[list_] = true;
    pair.touching[list_] = !found_[u].empty();
    near.state(pair).contacts[list_] = {contacts_.size(), found_[u].size()};
    contacts_.insert(contacts_.end(), found_[u].begin(), found_[u].end());
  }
}

void ContactStore::keep_only_near(NearPairs& near) {
  next_.clear();
  for (const NearPair& pair : near.list()) {
    if (!pair.touching[list_]) continue;
    const std::span<const Contact> kept = of(near.state(pair));
    near.state(pair).contacts[list_].first = next_.size();
    next_.insert(next_.end(), kept.begin(), kept.end());
  }
  std::swap(contacts_, next_);
}

}  // namespace sdm::bodies
