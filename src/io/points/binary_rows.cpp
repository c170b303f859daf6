#include "io/points/binary_rows.h"

#include <fmt/format.h>
#include <lzf.h>
#include <sdm/error.h>

#include <algorithm>
#include <array>

#include "io/file/byte_scanner.h"
#include "io/points/cloud_file.h"
#include "io/points/text/column_names.h"

namespace sdm::io {
namespace {

std::size_t numbers_of(const CloudLayout& layout) {
  return layout.has_normals ? kRoles : 3;
}

}  // namespace

BinaryRows::BinaryRows(std::ifstream& stream, std::uint64_t size, const CloudLayout& layout)
    : stream_(stream), layout_(layout), left_(layout.count) {
  if (layout.count > (size - layout.data_begin) / layout.stride)
    throw Error(
        fmt::format("the header declares {} points, more than the file can hold; it is truncated or damaged",
                    layout.count));
  seek(stream_, layout.data_begin);
}

void BinaryRows::read(std::size_t most, std::vector<Vec3>& points, std::vector<Vec3>& normals) {
  const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(most, left_));
  bytes_.resize(count * layout_.stride);
  take(stream_, bytes_.data(), bytes_.size());
  points.resize(count);
  normals.resize(layout_.has_normals ? count : 0);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < numbers_of(layout_); ++k) {
      const CloudColumn& column = layout_.columns[k];
      const char* at = bytes_.data() + i * layout_.stride + column.place;
      (k < 3 ? points[i][k] : normals[i][k - 3]) = load_number(at, column.type, layout_.order);
    }
  left_ -= count;
  if (!layout_.has_scale) return;
  for (Vec3& p : points)
    for (std::size_t k = 0; k < 3; ++k) p[k] = layout_.scale[k] * p[k] + layout_.offset[k];
}

CompressedColumns::CompressedColumns(std::ifstream& stream, std::uint64_t size, const CloudLayout& layout)
    : layout_(layout) {
  constexpr std::uint64_t kMostRatio = 100;  // of LZF: 264 bytes from 3
  std::array<char, 8> sizes{};
  const auto truncated = [] { return Error("the compressed data are cut off or damaged"); };
  if (size - layout.data_begin < sizes.size()) throw truncated();
  seek(stream, layout.data_begin);
  take(stream, sizes.data(), sizes.size());
  const auto packed = load<std::uint32_t>(sizes.data());
  const auto unpacked = load<std::uint32_t>(sizes.data() + 4);
  if (packed > size - layout.data_begin - sizes.size() || unpacked > kMostRatio * packed ||
      unpacked % layout.stride != 0 || unpacked / layout.stride != layout.count)
    throw truncated();
  std::vector<char> block(packed);
  take(stream, block.data(), block.size());
  bytes_.resize(unpacked);
  if (unpacked > 0 && lzf_decompress(block.data(), packed, bytes_.data(), unpacked) != unpacked)
    throw truncated();
}

void CompressedColumns::read(std::size_t most, std::vector<Vec3>& points, std::vector<Vec3>& normals) {
  const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(most, layout_.count - rows_));
  points.resize(count);
  normals.resize(layout_.has_normals ? count : 0);
  for (std::size_t k = 0; k < numbers_of(layout_); ++k) {
    const CloudColumn& column = layout_.columns[k];
    const char* first = bytes_.data() + layout_.count * column.place + rows_ * size_of(column.type);
    for (std::size_t i = 0; i < count; ++i)
      (k < 3 ? points[i][k] : normals[i][k - 3]) =
          load_number(first + i * size_of(column.type), column.type, layout_.order);
  }
  rows_ += count;
}

}  // namespace sdm::io
