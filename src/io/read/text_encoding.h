// Encodings of text.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace sdm::io {

/// Returns the bytes after the UTF-8 byte order mark, if they begin with it.
[[nodiscard]] inline std::string_view without_utf8_mark(std::string_view bytes) {
  return bytes.starts_with("\xEF\xBB\xBF") ? bytes.substr(3) : bytes;
}

/// Returns whether the bytes begin like text in UTF-16: with its byte order mark, or with characters of which
/// one byte is 0, the same of each.
[[nodiscard]] inline bool is_utf16(std::string_view bytes) {
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF")) return true;
  constexpr std::size_t kLeast = 4, kMost = 64;
  const std::size_t size = std::min(bytes.size(), kMost) / 2 * 2;
  if (size < kLeast) return false;
  const bool first = bytes[0] == '\0';
  for (std::size_t i = 0; i < size; ++i)
    if ((bytes[i] == '\0') != ((i % 2 == 0) == first)) return false;
  return true;
}

}  // namespace sdm::io
