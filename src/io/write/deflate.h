// Compression in the zlib format (RFC 1950), which PNG and OpenEXR use.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace sdm::io {

/// Returns whether the bytes, compressed, are fewer than `compressed` can hold, which is then resized to
/// them.
[[nodiscard]] bool deflate(std::span<const std::uint8_t> bytes, std::vector<std::uint8_t>& compressed);

/// Compresses a sequence of bytes that need not be in memory at once.
class DeflateStream {
 public:
  using Sink = std::function<void(std::span<const std::uint8_t>)>;

  /// Calls `sink` with blocks of at most 1 MiB.
  explicit DeflateStream(Sink sink);
  ~DeflateStream();
  DeflateStream(const DeflateStream&) = delete;
  DeflateStream& operator=(const DeflateStream&) = delete;

  void write(std::span<const std::uint8_t> bytes);
  /// Ends the sequence.
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sdm::io
