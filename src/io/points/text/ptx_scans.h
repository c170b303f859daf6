// Leica PTX: scans, each on a grid of directions, with their poses.
#pragma once

#include <sdm/mesh_edit.h>

#include <cstdint>
#include <string_view>

#include "io/points/text/point_source.h"
#include "io/points/text/text_lines.h"
#include "io/points/text/text_row.h"

namespace sdm::io {

/// Returns whether a text begins with the sizes of a grid, in a line each, and a line of three numbers.
[[nodiscard]] bool is_ptx(std::string_view begin);

/// The points of all scans, moved by the matrices of their scans; NaN where a direction has no measurement.
class PtxScans final : public PointSource {
 public:
  /// `size`: of the file in bytes, which limits the number of points that it can declare.
  PtxScans(TextLines lines, std::uint64_t size) : lines_(std::move(lines)), size_(size) {}
  void read(std::size_t most, std::vector<Vec3>& points, std::vector<Vec3>& normals) override;

 private:
  bool next_line(std::string_view& line);
  [[nodiscard]] std::string_view header_line();
  bool next_scan();
  template <std::size_t N>
  [[nodiscard]] std::array<double, N> header_numbers();

  TextLines lines_;
  std::uint64_t size_, left_ = 0;  // points of the current scan
  std::uint64_t scans_ = 0;
  RowPlan plan_;
  bool planned_ = false;
  Transform pose_{};
};

}  // namespace sdm::io
