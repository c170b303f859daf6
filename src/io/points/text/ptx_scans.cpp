#include "io/points/text/ptx_scans.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace sdm::io {
namespace {

constexpr std::uint64_t kLeastRow = 6;  // bytes: "0 0 0\n"

template <std::size_t N>
bool read_numbers(std::string_view line, std::array<double, N>& numbers) {
  RowScanner row(line, TextSeparator::blank, DecimalMark::point);
  for (double& x : numbers)
    if (!row.more() || !row.number(x) || !std::isfinite(x)) return false;
  return !row.more();
}

std::size_t columns_of(std::string_view line) {
  std::size_t columns = 0;
  for (RowScanner row(line, TextSeparator::blank, DecimalMark::point); row.more(); ++columns)
    (void)row.text();
  return columns;
}

}  // namespace

bool is_ptx(std::string_view begin) {
  const char end = line_end_of(begin);
  for (int i = 0; i < 3;) {
    if (begin.empty()) return false;
    const std::string_view line = take_line(begin, end);
    if (is_empty_row(line)) continue;
    std::array<double, 3> position{};
    if (i < 2 ? !lone_count(line) : !read_numbers(line, position)) return false;
    ++i;
  }
  return true;
}

// The next line that is not empty. Returns whether there is one.
bool PtxScans::next_line(std::string_view& line) {
  while (const auto next = lines_.next()) {
    line = *next;
    if (!is_empty_row(line)) return true;
  }
  return false;
}

std::string_view PtxScans::header_line() {
  std::string_view line;
  if (!next_line(line))
    throw Error(fmt::format("ends within the header of scan {}; it is truncated", scans_));
  return line;
}

template <std::size_t N>
std::array<double, N> PtxScans::header_numbers() {
  std::array<double, N> numbers{};
  if (!read_numbers(header_line(), numbers))
    lines_.fail(fmt::format("expected {} numbers in the header of a PTX scan", N));
  return numbers;
}

// Reads the header of the next scan. Returns whether there is one.
bool PtxScans::next_scan() {
  ++scans_;
  std::string_view line;
  if (!next_line(line)) return false;
  const auto columns = lone_count(line);
  if (!columns) lines_.fail("expected the number of columns of another PTX scan");
  const auto rows = lone_count(header_line());
  if (!rows) lines_.fail("expected the number of rows of a PTX scan");
  if (*rows > 0 && *columns > size_ / kLeastRow / *rows)
    lines_.fail(
        fmt::format("a scan of {} by {} points, more than the file can hold; it is truncated or damaged",
                    *columns, *rows));
  left_ = *columns * *rows;
  for (int i = 0; i < 4; ++i) (void)header_numbers<3>();  // the position and the axes of the scanner
  // Points are rows, which the matrix is multiplied to from the right: its last row is the translation.
  for (std::size_t i = 0; i < 4; ++i) {
    const std::array<double, 4> row = header_numbers<4>();
    for (std::size_t k = 0; k < 3; ++k) pose_.rows[k][i] = row[k];
    if (row[3] != (i == 3 ? 1 : 0))
      lines_.fail("the matrix of a PTX scan must have the last column 0, 0, 0, 1");
  }
  planned_ = false;
  return true;
}

void PtxScans::read(std::size_t most, std::vector<Vec3>& points, std::vector<Vec3>& /*normals*/) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  while (points.size() < most) {
    if (left_ == 0) {
      if (!next_scan()) return;
      continue;
    }
    std::string_view line;
    if (!next_line(line))
      throw Error(fmt::format("scan {} lacks {} of its points; the file is truncated", scans_, left_));
    if (!planned_) {
      plan_.columns = std::max<std::size_t>(columns_of(line), 3);
      plan_.want({0, 1, 2});
      planned_ = true;
    }
    RowNumbers n;
    if (!read_row(line, plan_, n)) lines_.fail(row_fault(line, plan_));
    const Vec3 p{n[0], n[1], n[2]};
    points.push_back(p == Vec3{0, 0, 0} ? Vec3{kNan, kNan, kNan} : pose_(p));
    --left_;
  }
}

}  // namespace sdm::io
