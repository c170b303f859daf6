// The points of a cloud with the largest distance of each neighbourhood.
#pragma once

#include <sdm/types.h>

#include <cstdint>
#include <vector>

namespace sdm::io {

struct CellPlace {
  double distance = 0;
  Vec3 point{};
  std::uint64_t sample = kNone;  ///< the number of the point
};

/// The place of the largest |distance| in each cell of a grid over a box. Cells are 6 % of the diagonal wide.
class LargestByCell {
 public:
  /// Places outside of the box belong to the cells at its border.
  explicit LargestByCell(const Box& box);
  /// Ignores what is not finite.
  void add(const CellPlace& place);
  /// The places of all cells that have one other than 0, the largest |distance| first.
  [[nodiscard]] std::vector<CellPlace> largest() const;

 private:
  static constexpr double kWidth = 0.06;    // of the diagonal
  static constexpr std::size_t kSide = 18;  // cells along a side of the box, which is at most the diagonal
  static_assert(kSide * kWidth > 1);

  [[nodiscard]] std::size_t cell(const Vec3& p) const;

  Vec3 lo_;
  double width_;
  std::vector<CellPlace> places_;
};

}  // namespace sdm::io
