#include "bodies/contacts/contact_order.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>

namespace sdm::contacts {

void ContactOrder::sort(std::vector<Contact>& contacts, double same) {
  order_.resize(contacts.size());
  std::iota(order_.begin(), order_.end(), 0u);
  // Distinct keys make the order unique; a stable sort would allocate memory.
  std::ranges::sort(order_, {}, [&](std::uint32_t c) { return std::pair(-contacts[c].depth, c); });
  const std::span<std::uint32_t> all = order_;
  for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
    while (end < all.size() && contacts[all[end]].depth >= contacts[all[begin]].depth - same) ++end;
    std::ranges::sort(all.subspan(begin, end - begin), {},
                      [&](std::uint32_t c) { return std::pair(contacts[c].id, c); });
  }
  std::uint32_t patches = 0;
  for (const Contact& c : contacts) patches = std::max(patches, c.patch + 1);
  number_.assign(patches, kNone);
  std::uint32_t next = 0;
  sorted_.clear();
  for (const std::uint32_t c : order_) {
    std::uint32_t& number = number_[contacts[c].patch];
    if (number == kNone) number = next++;
    sorted_.push_back(contacts[c]);
    sorted_.back().patch = number;
  }
  for (std::uint32_t i = 0; i < order_.size(); ++i) order_[i] = i;
  std::ranges::sort(order_, {}, [&](std::uint32_t i) { return std::pair(sorted_[i].patch, i); });
  for (std::size_t i = 0; i < order_.size(); ++i) contacts[i] = sorted_[order_[i]];
}

}  // namespace sdm::contacts
