#include "atlas/packing/room.h"

#include <algorithm>
#include <cmath>

namespace sdm::atlas {
namespace {

// The columns that the part of the triangle between two rows of y touches.
std::array<double, 2> range_between(const std::array<Vec2, 3>& t, double top, double bottom) {
  double left = kInfinity, right = -left;
  const auto include = [&](double x) {
    left = std::min(left, x);
    right = std::max(right, x);
  };
  for (int k = 0; k < 3; ++k) {
    const Vec2 &a = t[k], &b = t[(k + 1) % 3];
    if (a[1] >= top && a[1] <= bottom) include(a[0]);
    for (const double line : {top, bottom})
      if (std::min(a[1], b[1]) < line && line < std::max(a[1], b[1]))
        include(a[0] + (line - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
  }
  return {left, right};
}

std::uint32_t at_least_0(double x) {
  return static_cast<std::uint32_t>(std::max(0.0, std::floor(x)));
}

}  // namespace

TouchedRows::TouchedRows(const std::array<Vec2, 3>& t, std::uint32_t gutter) {
  const auto [lo, hi] = std::minmax({t[0][1], t[1][1], t[2][1]});
  const double first = std::floor(lo), last = std::floor(hi);
  const auto count = static_cast<std::size_t>(last - first) + 1;
  std::vector<std::array<double, 2>> ranges(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double top = first + static_cast<double>(i);
    ranges[i] = range_between(t, top, top + 1);
  }
  first_row = at_least_0(first - gutter);
  const std::uint32_t end_row = at_least_0(last + gutter) + 1;
  columns.resize(end_row - first_row);
  for (std::uint32_t y = first_row; y < end_row; ++y) {
    const double row = y - first;
    const auto from = static_cast<std::size_t>(std::max(0.0, row - gutter));
    const auto to = static_cast<std::size_t>(std::min(last - first, row + gutter));
    double left = kInfinity, right = -left;
    for (std::size_t i = from; i <= to; ++i) {
      left = std::min(left, ranges[i][0]);
      right = std::max(right, ranges[i][1]);
    }
    columns[y - first_row] = {at_least_0(left - gutter), at_least_0(right + gutter) + 1};
  }
}

Room::Room(std::uint32_t resolution, std::uint32_t rows, std::uint32_t gutter)
    : resolution_(resolution), rows_(rows), gutter_(gutter), counts_(std::size_t{resolution} * rows, 0) {}

template <class Change>
void Room::for_each_count(const std::array<Vec2, 3>& face, const Change& change) {
  const TouchedRows touched(face, gutter_);
  for (std::size_t i = 0; i < touched.columns.size() && touched.first_row + i < rows_; ++i) {
    const auto [begin, end] = touched.columns[i];
    for (std::size_t x = begin; x < std::min(end, resolution_); ++x)
      change(counts_[(touched.first_row + i) * resolution_ + x]);
  }
}

void Room::add(const std::array<Vec2, 3>& face) {
  for_each_count(face, [](std::uint16_t& count) {
    if (count < kMany) ++count;
  });
}

void Room::remove(const std::array<Vec2, 3>& face) {
  for_each_count(face, [](std::uint16_t& count) {
    if (count < kMany) --count;
  });
}

void Room::grow(std::uint32_t rows) {
  rows_ = rows;
  counts_.resize(std::size_t{resolution_} * rows, 0);
}

BitmapBin Room::bin(std::uint32_t more_rows, std::uint32_t longest) const {
  return BitmapBin(resolution_, rows_ + more_rows, longest, counts_);
}

}  // namespace sdm::atlas
