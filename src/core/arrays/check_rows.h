// Whether rows that were read from a file are those of given items.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/arrays/rows.h"

namespace sdm::core {

/// Puts items into rows once more, as make_rows() does, and compares them with what is there. Rows may have
/// any contents.
class RowCheck {
 public:
  /// There must be an offset, at least.
  explicit RowCheck(const CompressedRows<std::uint32_t>& rows)
      : offsets_(rows.offsets), items_(rows.items), next_(offsets_.begin(), offsets_.end() - 1) {}

  /// Whether the row, which must exist, has room for the item; what is there is compared by `complete`.
  [[nodiscard]] bool put(std::size_t row, std::uint32_t item) {
    const std::uint32_t at = next_[row]++;
    if (at >= items_.size()) return false;
    fault_ |= items_[at] ^ item;
    return true;
  }
  /// Whether the rows have all items that were put into them in this order, and no others.
  [[nodiscard]] bool complete() const {
    std::uint32_t fault = fault_ | offsets_.front();
    for (std::size_t row = 0; row < next_.size(); ++row) fault |= next_[row] ^ offsets_[row + 1];
    return fault == 0 && offsets_.back() == items_.size();
  }

 private:
  std::span<const std::uint32_t> offsets_, items_;
  std::vector<std::uint32_t> next_;  // of each row: the place of its next item
  std::uint32_t fault_ = 0;          // the sum, by bits, of numbers that are 0 where all is as it must be
};

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
