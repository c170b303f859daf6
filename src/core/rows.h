// Lists of various lengths, one after the other in one array.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace sdm::core {

/// Row i is items[offsets[i]] ... items[offsets[i + 1]].
template <class Item>
struct CompressedRows {
  std::vector<std::uint32_t> offsets;
  std::vector<Item> items;

  [[nodiscard]] std::size_t size() const { return offsets.size() - 1; }
  [[nodiscard]] std::span<const Item> of(std::size_t row) const {
    return {items.data() + offsets[row], items.data() + offsets[row + 1]};
  }
  [[nodiscard]] std::span<Item> of(std::size_t row) {
    return {items.data() + offsets[row], items.data() + offsets[row + 1]};
  }
};

/// Sorts items into rows by counting: visit(put) calls put(row, item) for each, and is run twice. Items of a
/// row keep their order.
template <class Item, class Visit>
CompressedRows<Item> make_rows(std::size_t count, const Visit& visit) {
  // offsets[i + 2] counts row i, offsets[i + 1] then runs from its begin to its end, where row i + 1 begins.
  CompressedRows<Item> rows{std::vector<std::uint32_t>(count + 2, 0), {}};
  visit([&](std::size_t row, const Item&) { ++rows.offsets[row + 2]; });
  std::partial_sum(rows.offsets.begin(), rows.offsets.end(), rows.offsets.begin());
  rows.items.resize(rows.offsets.back());
  visit([&](std::size_t row, const Item& item) { rows.items[rows.offsets[row + 1]++] = item; });
  rows.offsets.pop_back();
  return rows;
}

}  // namespace sdm::core

namespace sdm {
using namespace core;  // the vocabulary of every folder
}
