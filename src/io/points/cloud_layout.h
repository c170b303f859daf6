// Where the coordinates are in the rows of a cloud's file.
#pragma once

#include <sdm/types.h>

#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <string_view>

#include "io/file/number_type.h"

namespace sdm::io {

/// Where a row has one of x, y, z and the three components of the normal.
struct CloudColumn {
  std::size_t place = 0;  ///< of text: the index of the number; else the offset in bytes
  NumberType type = NumberType::float64;
};

struct CloudLayout {
  std::string_view format;
  bool text = false;
  std::endian order = std::endian::little;
  std::uint64_t data_begin = 0;
  std::uint64_t count = 0;
  std::size_t stride = 0;  ///< numbers, or bytes, of a row
  std::array<CloudColumn, 6> columns{};
  bool has_normals = false;
  bool has_scale = false;  ///< coordinates are scale · number + offset
  Vec3 scale{}, offset{};
  /// Binary_compressed PCD: the data are two lengths and one block of LZF, with the numbers of a column
  /// together.
  bool compressed = false;
};

/// The bytes of a file that are read for its header, at most.
inline constexpr std::size_t kMaxCloudHeader = std::size_t{1} << 18;

/// The layout of a PLY, PCD or LAS file that begins with `bytes`, of which kMaxCloudHeader suffice; nothing
/// if the file has none of these formats. Throws sdm::Error, which does not name the file.
[[nodiscard]] std::optional<CloudLayout> cloud_layout(std::string_view bytes);

}  // namespace sdm::io
