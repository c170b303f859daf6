// Compression of blocks in memory by ISA-L, several times as fast as zlib's fastest level.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace sdm::io {

/// Returns the bytes in zlib's format; nothing if they would not get smaller.
[[nodiscard]] std::vector<std::uint8_t> zlib_compressed(std::span<const std::uint8_t> bytes);

/// Returns the bytes as blocks of deflate that end on a whole byte. The parts of a stream are compressed
/// independently of each other and concatenated; the last one ends the stream.
[[nodiscard]] std::vector<std::uint8_t> deflate_part(std::span<const std::uint8_t> bytes, bool last);

}  // namespace sdm::io
