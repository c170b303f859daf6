#include "bodies/contacts/contact_patches.h"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

namespace sdm::contacts {

std::span<const Contact> ContactPatches::sort(std::span<Contact> contacts, std::span<const Box> boxes) {
  groups_.find(boxes, patches_);
  order_.resize(contacts.size());
  std::iota(order_.begin(), order_.end(), 0u);
  // Distinct keys make the order unique; a stable sort would allocate memory.
  std::ranges::sort(order_, {}, [&](std::uint32_t c) { return std::pair(-contacts[c].depth, c); });
  constexpr std::uint32_t kUnnumbered = kNone;
  std::uint32_t patches = 0;
  patch_of_.assign(boxes.size(), kUnnumbered);
  for (const std::uint32_t c : order_) {
    std::uint32_t& patch = patch_of_[patches_.find(c)];
    if (patch == kUnnumbered) patch = patches++;
    contacts[c].patch = patch;
  }
  std::ranges::sort(order_, {},
                    [&](std::uint32_t c) { return std::tuple(contacts[c].patch, -contacts[c].depth, c); });
  sorted_.clear();
  for (const std::uint32_t c : order_) sorted_.push_back(contacts[c]);
  return sorted_;
}

}  // namespace sdm::contacts
