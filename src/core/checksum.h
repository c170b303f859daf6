// XXH3 with 64 bits: checksums of stored atlases, and of files in reports.
#pragma once

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace sdm::core {

/// The checksum of bytes that arrive in parts; how they are divided changes nothing.
class Checksum {
 public:
  Checksum() { XXH3_64bits_reset(&state_); }

  template <class Item>
  void add(std::span<const Item> items) {
    static_assert(std::is_trivially_copyable_v<Item>);
    XXH3_64bits_update(&state_, items.data(), items.size_bytes());
  }
  template <class Item>
  void add(const std::vector<Item>& items) {
    add(std::span<const Item>(items));
  }

  [[nodiscard]] std::uint64_t value() const { return XXH3_64bits_digest(&state_); }

 private:
  XXH3_state_t state_;
};

/// 16 hexadecimal digits, as `xxhsum -H3` prints them.
[[nodiscard]] inline std::string hex_text(std::uint64_t checksum) {
  std::string text(16, '0');
  for (std::size_t i = 0; i < text.size(); ++i) text[i] = "0123456789abcdef"[checksum >> (60 - 4 * i) & 15];
  return text;
}

}  // namespace sdm::core
