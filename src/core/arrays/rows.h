// Rows of varying length, stored consecutively in one array.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "core/arrays/array.h"

namespace sdm::core {

/// Row i is items[offsets[i]] up to, but not including, items[offsets[i + 1]].
template <class Item, class Offset = std::uint32_t>
struct CompressedRows {
  Array<Offset> offsets;  ///< start of each row, and the end of the last
  Array<Item> items;

  [[nodiscard]] std::size_t size() const { return offsets.size() - 1; }
  [[nodiscard]] std::span<const Item> of(std::size_t row) const {
    return {items.data() + offsets[row], items.data() + offsets[row + 1]};
  }
  [[nodiscard]] std::span<Item> of(std::size_t row) {
    return {items.data() + offsets[row], items.data() + offsets[row + 1]};
  }

  /// See core/arrays/stored_arrays.h.
  template <class Self, class Visit>
  static void for_each_member(Self& self, const Visit& visit) {
    auto& [offsets, items] = self;
    visit(offsets);
    visit(items);
  }
};

/// Sorts items into rows by a counting sort: visit(put) calls put(row, item) for each item, and is called
/// twice. Items of a row keep their order.
template <class Item, class Offset = std::uint32_t, class Visit>
CompressedRows<Item, Offset> make_rows(std::size_t count, const Visit& visit) {
  // offsets[i + 2] counts row i; offsets[i + 1] then advances from the start of row i to its end, where row i
  // + 1 starts.
  std::vector<Offset> offsets(count + 2, 0);
  visit([&](std::size_t row, const Item&) { ++offsets[row + 2]; });
  std::partial_sum(offsets.begin(), offsets.end(), offsets.begin());
  std::vector<Item> items(offsets.back());
  visit([&](std::size_t row, const Item& item) { items[offsets[row + 1]++] = item; });
  offsets.pop_back();
  return {std::move(offsets), std::move(items)};
}

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
