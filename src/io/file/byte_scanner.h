// Numbers in binary data.
#pragma once

#include <sdm/error.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <string_view>

namespace sdm::io {

/// Returns the number stored at `bytes` in the given byte order.
template <typename T>
[[nodiscard]] T load(const char* bytes, std::endian order = std::endian::little) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), bytes, sizeof(T));
  if (order != std::endian::native) std::reverse(raw.begin(), raw.end());
  return std::bit_cast<T>(raw);
}

/// Reads binary data from front to back, never past its end.
class ByteScanner {
 public:
  explicit ByteScanner(std::string_view bytes, std::endian order = std::endian::little)
      : bytes_(bytes), order_(order) {}

  [[nodiscard]] std::size_t remaining() const { return bytes_.size(); }
  /// Takes the next `count` bytes. Throws sdm::Error if fewer are left.
  std::string_view take(std::size_t count) {
    if (count > bytes_.size()) throw Error("unexpected end of data; the file is truncated or damaged");
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }
  template <typename T>
  T number() {
    return load<T>(take(sizeof(T)).data(), order_);
  }

 private:
  std::string_view bytes_;
  std::endian order_;
};

}  // namespace sdm::io
