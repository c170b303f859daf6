#include "core/printable.h"

#include <array>
#include <cstdint>

#include "core/excerpt.h"

namespace sdm {
namespace {

struct Character {
  std::uint32_t code = 0;
  std::size_t bytes = 0;  // 0: not UTF-8
};

// Decodes the first character of `text`, which is not empty.
Character first_character(std::string_view text) {
  const auto byte = [&](std::size_t i) { return std::uint32_t{static_cast<unsigned char>(text[i])}; };
  if (byte(0) < 0x80) return {byte(0), 1};
  const std::size_t bytes = byte(0) >> 5 == 0x6 ? 2 : byte(0) >> 4 == 0xE ? 3 : byte(0) >> 3 == 0x1E ? 4 : 0;
  if (bytes == 0 || text.size() < bytes) return {};
  std::uint32_t code = byte(0) & 0x7Fu >> bytes;
  for (std::size_t i = 1; i < bytes; ++i) {
    if (byte(i) >> 6 != 0x2) return {};
    code = code << 6 | (byte(i) & 0x3F);
  }
  // Overlong forms would hide control characters from a check of bytes.
  constexpr std::array<std::uint32_t, 5> least{0, 0, 0x80, 0x800, 0x10000};
  if (code < least[bytes] || code > 0x10FFFF || (code >= 0xD800 && code <= 0xDFFF)) return {};
  return {code, bytes};
}

// C0, DEL and C1; line and paragraph separators; marks, embeddings, overrides and isolates of direction.
bool is_unprintable(std::uint32_t code) {
  return code < 0x20 || (code >= 0x7F && code < 0xA0) || code == 0x61C || code == 0x200E || code == 0x200F ||
         (code >= 0x2028 && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069);
}

void append_hex(std::string& out, std::string_view prefix, std::uint32_t value, int digits) {
  out += prefix;
  for (int shift = 4 * (digits - 1); shift >= 0; shift -= 4) out += "0123456789abcdef"[value >> shift & 0xF];
}

}  // namespace

std::string printable(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const auto [code, bytes] = first_character(text);
    if (bytes == 0)
      append_hex(out, "\\x", static_cast<unsigned char>(text[0]), 2);
    else if (is_unprintable(code))
      append_hex(out, "\\u", code, 4);
    else
      out += text.substr(0, bytes);
    text.remove_prefix(bytes == 0 ? 1 : bytes);
  }
  return out;
}

std::string core::excerpt(std::string_view text, std::size_t most) {
  if (text.size() <= most) return printable(text);
  // A character is not cut, unless it is not UTF-8 anyway.
  std::size_t end = most;
  while (end > 0 && most - end < 3 && static_cast<unsigned char>(text[end]) >> 6 == 0x2) --end;
  return printable(text.substr(0, end)) + "...";
}

}  // namespace sdm
