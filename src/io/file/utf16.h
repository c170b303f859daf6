// Recognises text that is not UTF-8.
#pragma once

#include <algorithm>
#include <string_view>

namespace sdm::io {

/// The fault of a file for which is_utf16() holds.
inline constexpr std::string_view kUtf16Fault = "this is UTF-16 text; save it as UTF-8";

/// Returns whether the bytes begin with a byte order mark of UTF-16, or with ASCII characters of two bytes
/// each. Cost: O(1).
[[nodiscard]] inline bool is_utf16(std::string_view bytes) {
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF")) return true;
  constexpr std::size_t kMost = 64;
  const std::size_t size = std::min(bytes.size() / 2 * 2, kMost);
  const auto is_ascii = [](char c) { return (c >= ' ' && c <= '~') || (c >= '\t' && c <= '\r'); };
  for (const std::size_t zero : {1u, 0u}) {  // the byte that is 0: the second one in little-endian order
    std::size_t at = 0;
    while (at < size && bytes[at + zero] == '\0' && is_ascii(bytes[at + 1 - zero])) at += 2;
    if (size >= 8 && at == size) return true;
  }
  return false;
}

}  // namespace sdm::io
