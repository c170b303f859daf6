#include "io/points/text/text_rows.h"

#include <fmt/format.h>
#include <sdm/error.h>

namespace sdm::io {
namespace {

void append(const TextLines& lines, std::string_view line, const RowPlan& plan, std::vector<Vec3>& points,
            std::vector<Vec3>& normals) {
  RowNumbers n;
  if (!read_row(line, plan, n)) lines.fail(row_fault(line, plan));
  points.push_back({n[0], n[1], n[2]});
  if (plan.has_normals()) normals.push_back({n[3], n[4], n[5]});
}

Error truncated(std::uint64_t rows, std::uint64_t count) {
  return Error(fmt::format("ends after {} of {} points; it is truncated", rows, count));
}

}  // namespace

void TextRows::read(std::size_t most, std::vector<Vec3>& points, std::vector<Vec3>& normals) {
  while (points.size() < most) {
    const auto line = lines_.next();
    if (!line) {
      if (count_ && rows_ < *count_) throw truncated(rows_, *count_);
      return;
    }
    if (lines_.number() == table_.dialect.header_line || is_empty_row(*line)) continue;
    if (rows_ == count_.value_or(0)) {
      if (const auto count = lone_count(*line)) {
        count_ = count;
        rows_ = 0;
        continue;
      }
      if (count_) lines_.fail(kMoreRows);
    }
    append(lines_, *line, table_.plan, points, normals);
    ++rows_;
  }
}

void DeclaredRows::read(std::size_t most, std::vector<Vec3>& points, std::vector<Vec3>& normals) {
  while (points.size() < most && rows_ < count_) {
    const auto line = lines_.next();
    if (!line) throw truncated(rows_, count_);
    if (is_empty_row(*line)) continue;
    append(lines_, *line, plan_, points, normals);
    ++rows_;
  }
}

}  // namespace sdm::io
