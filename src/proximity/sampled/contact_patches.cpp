#include "proximity/sampled/contact_patches.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <tuple>
#include <utility>

namespace sdm::sampled {
namespace {

bool meet(const Box& a, const Box& b) {
  for (int k = 0; k < 3; ++k)
    if (a.hi[k] < b.lo[k] || b.hi[k] < a.lo[k]) return false;
  return true;
}

}  // namespace

std::span<const Contact> ContactPatches::sort(std::span<Contact> contacts, std::span<const Box> boxes) {
  find_patches(boxes);
  std::iota(order_.begin(), order_.end(), 0u);
  // By distinct keys: a stable sort would take memory.
  std::ranges::sort(order_, {}, [&](std::uint32_t c) { return std::pair(-contacts[c].depth, c); });
  constexpr std::uint32_t kUnnumbered = kNone;
  std::uint32_t patches = 0;
  for (Contact& c : contacts) c.patch = kUnnumbered;
  for (const std::uint32_t c : order_)
    if (std::uint32_t& patch = contacts[root(c)].patch; patch == kUnnumbered) patch = patches++;
  for (const std::uint32_t c : order_) contacts[c].patch = contacts[root(c)].patch;
  std::ranges::sort(order_, {},
                    [&](std::uint32_t c) { return std::tuple(contacts[c].patch, -contacts[c].depth, c); });
  sorted_.clear();
  for (const std::uint32_t c : order_) sorted_.push_back(contacts[c]);
  return sorted_;
}

// Joins contacts whose boxes meet, by a sweep along x.
void ContactPatches::find_patches(std::span<const Box> boxes) {
  parent_.resize(boxes.size());
  order_.resize(boxes.size());
  std::iota(parent_.begin(), parent_.end(), 0u);
  std::iota(order_.begin(), order_.end(), 0u);
  std::ranges::sort(order_, {}, [&](std::uint32_t c) { return std::pair(boxes[c].lo[0], c); });
  open_.clear();
  for (const std::uint32_t c : order_) {
    std::erase_if(open_, [&](std::uint32_t o) { return boxes[o].hi[0] < boxes[c].lo[0]; });
    for (const std::uint32_t o : open_)
      if (meet(boxes[o], boxes[c])) join(c, o);
    open_.push_back(c);
  }
}

std::uint32_t ContactPatches::root(std::uint32_t contact) {
  while (parent_[contact] != contact) contact = parent_[contact] = parent_[parent_[contact]];
  return contact;
}

void ContactPatches::join(std::uint32_t a, std::uint32_t b) {
  a = root(a), b = root(b);
  parent_[std::max(a, b)] = std::min(a, b);
}

}  // namespace sdm::sampled
