// Where the coordinates are in the rows of a cloud's file.
#pragma once

#include <sdm/types.h>

#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <string_view>

#include "io/read/ply_header.h"

namespace sdm::io {

/// Of x, y, z and the three components of the normal.
struct CloudColumn {
  std::size_t place = 0;  ///< of text: the index of the number; else the offset in bytes
  PlyHeader::Type type = PlyHeader::Type::float64;
};

struct CloudLayout {
  bool text = false;
  bool fixed_columns = true;  ///< of text: further numbers on a line are a fault
  std::endian order = std::endian::little;
  std::uint64_t data_begin = 0;
  std::optional<std::uint64_t> count;
  std::size_t stride = 0;  ///< numbers, or bytes, of a row
  std::array<CloudColumn, 6> columns{};
  bool has_normals = false;
  bool has_scale = false;  ///< coordinates are scale · number + offset
  Vec3 scale{}, offset{};
  /// Binary_compressed PCD: the data are two lengths and one block of LZF, with the numbers of a column
  /// together.
  bool compressed = false;
};

/// At most as much of a file is read for its header.
inline constexpr std::size_t kMaxCloudHeader = std::size_t{1} << 18;

/// The layout of a file that begins with `bytes`, of which kMaxCloudHeader suffice. Throws sdm::Error, which
/// does not name the file.
[[nodiscard]] CloudLayout cloud_layout(std::string_view bytes);

}  // namespace sdm::io
