// Points from the rows of a text.
#pragma once

#include <cstdint>
#include <optional>

#include "io/points/text/point_source.h"
#include "io/points/text/text_dialect.h"
#include "io/points/text/text_lines.h"

namespace sdm::io {

/// Text without a format of its own: rows, before which there may be a header and their number. After as many
/// rows another number and its rows may follow.
class TextRows final : public PointSource {
 public:
  TextRows(TextLines lines, const TextTable& table) : lines_(std::move(lines)), table_(table) {}
  void read(std::size_t most, std::vector<Vec3>& points, std::vector<Vec3>& normals) override;

 private:
  TextLines lines_;
  TextTable table_;
  std::uint64_t rows_ = 0;              // since the last number of rows
  std::optional<std::uint64_t> count_;  // the last number of rows
};

/// The rows of PLY and PCD, whose header has their number.
class DeclaredRows final : public PointSource {
 public:
  DeclaredRows(TextLines lines, const RowPlan& plan, std::uint64_t count)
      : lines_(std::move(lines)), plan_(plan), count_(count) {}
  void read(std::size_t most, std::vector<Vec3>& points, std::vector<Vec3>& normals) override;

 private:
  TextLines lines_;
  RowPlan plan_;
  std::uint64_t rows_ = 0, count_;
};

}  // namespace sdm::io
