#include "bodies/contacts/contact_patches.h"

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
    ++end;
    while (end < all.size() && contacts[all[end]].depth >= contacts[all[begin]].depth - same) ++end;
    std::ranges::sort(all.subspan(begin, end - begin), {},
                      [&](std::uint32_t c) { return std::pair(contacts[c].id, c); });
  }
  // Numbers the patches by their first contacts, and puts the contacts of each together.
  std::uint32_t labels = 0;
  for (const Contact& c : contacts) labels = std::max(labels, c.patch + 1);
  number_.assign(labels, kNone);
  place_.clear();
  for (const std::uint32_t c : order_) {
    std::uint32_t& number = number_[contacts[c].patch];
    if (number == kNone) {
      number = static_cast<std::uint32_t>(place_.size());
      place_.push_back(0);
    }
    ++place_[number];
  }
  std::exclusive_scan(place_.begin(), place_.end(), place_.begin(), 0u);
  sorted_.resize(contacts.size());
  for (const std::uint32_t c : order_) {
    const std::uint32_t number = number_[contacts[c].patch];
    Contact& contact = sorted_[place_[number]++];
    contact = contacts[c];
    contact.patch = number;
  }
  std::ranges::copy(sorted_, contacts.begin());  // spans of them stay valid
}

void ContactPatches::sort(std::vector<Contact>& contacts, std::span<const Box> boxes, double same) {
  groups_.find(boxes, patches_);
  for (std::uint32_t c = 0; c < contacts.size(); ++c) contacts[c].patch = patches_.find(c);
  order_.sort(contacts, same);
}

}  // namespace sdm::contacts
