#include "io/file/deflate.h"

#include <isa-l/igzip_lib.h>
#include <sdm/error.h>

#include <memory>

namespace sdm::io {
namespace {

// Compresses to at most `most` bytes; returns nothing if these do not suffice.
std::vector<std::uint8_t> compressed(std::span<const std::uint8_t> bytes, std::size_t most,
                                     std::uint16_t format, std::uint16_t flush) {
  // The second of three levels: 1 to 2 % larger than by libdeflate's fastest, in a third of the time.
  constexpr std::uint32_t kLevel = 2;
  std::vector<std::uint8_t> buffer(ISAL_DEF_LVL2_DEFAULT), result(most);
  const auto on_heap = std::make_unique<isal_zstream>();  // 80 kB, too much for a small stack
  isal_zstream& stream = *on_heap;
  isal_deflate_stateless_init(&stream);
  stream.level = kLevel;
  stream.level_buf = buffer.data();
  stream.level_buf_size = static_cast<std::uint32_t>(buffer.size());
  stream.gzip_flag = format;
  stream.flush = flush;
  stream.end_of_stream = flush == NO_FLUSH;
  stream.next_in = const_cast<std::uint8_t*>(bytes.data());  // ISA-L only reads it
  stream.avail_in = static_cast<std::uint32_t>(bytes.size());
  stream.next_out = result.data();
  stream.avail_out = static_cast<std::uint32_t>(result.size());
  result.resize(isal_deflate_stateless(&stream) == COMP_OK ? stream.total_out : 0);
  return result;
}

}  // namespace

std::vector<std::uint8_t> zlib_compressed(std::span<const std::uint8_t> bytes) {
  return compressed(bytes, bytes.size() - 1, IGZIP_ZLIB, NO_FLUSH);
}

std::vector<std::uint8_t> deflate_part(std::span<const std::uint8_t> bytes, bool last) {
  // Stored blocks of at most 65535 bytes with headers of 5, if nothing is saved.
  const std::size_t most = bytes.size() + 5 * (bytes.size() / 65535 + 1) + 64;
  std::vector<std::uint8_t> part = compressed(bytes, most, IGZIP_DEFLATE, last ? NO_FLUSH : FULL_FLUSH);
  if (part.empty()) throw Error("ISA-L failed to compress an image");  // rather than a damaged file
  return part;
}

}  // namespace sdm::io
