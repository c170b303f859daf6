// Rows of varying length, stored consecutively in one array.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace sdm::core {

/// Row i is items[offsets[i]] up to, but not including, items[offsets[i + 1]].
template <class Item, class Offset = std::uint32_t>
struct CompressedRows {
  std::vector<Offset> offsets;  ///< start of each row, and the end of the last
  std::vector<Item> items;

  [[nodiscard]] std::size_t size() const { return offsets.size() - 1; }
  [[nodiscard]] std::span<const Item> of(std::size_t row) const {
    return {items.data() + offsets[row], items.data() + offsets[row + 1]};
  }
  [[nodiscard]] std::span<Item> of(std::size_t row) {
    return {items.data() + offsets[row], items.data() + offsets[row + 1]};
  }
};

/// Sorts items into rows by a counting sort: visit(put) calls put(row, item) for each item, and is called
/// twice. Items of a row keep their order.
template <class Item, class Offset = std::uint32_t, class Visit>
CompressedRows<Item, Offset> make_rows(std::size_t count, const Visit& visit) {
  // offsets[i + 2] counts row i; offsets[i + 1] then advances from the start of row i to its end, where row i
  // + 1 starts.
  CompressedRows<Item, Offset> rows{std::vector<Offset>(count + 2, 0), {}};
  visit([&](std::size_t row, const Item&) { ++rows.offsets[row + 2]; });
  std::partial_sum(rows.offsets.begin(), rows.offsets.end(), rows.offsets.begin());
  rows.items.resize(rows.offsets.back());
  visit([&](std::size_t row, const Item& item) { rows.items[rows.offsets[row + 1]++] = item; });
  rows.offsets.pop_back();
  return rows;
}

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
