// Recognises files whose content is encoded in a way that no reader decodes: text in UTF-16, archives, files
// that are compressed as a whole.
#pragma once

#include <sdm/error.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

namespace sdm::io {

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

/// Throws sdm::Error if a file that begins with these bytes has to be decoded first. Cost: O(1).
inline void refuse_encoded(std::string_view bytes) {
  using namespace std::string_view_literals;
  struct Signature {
    std::string_view begin, fault;
  };
  constexpr std::array kSignatures{
      Signature{"\x1F\x8B\x08"sv, "is compressed with gzip; decompress it first"},
      Signature{"BZh"sv, "is compressed with bzip2; decompress it first"},
      Signature{"\xFD"
                "7zXZ\0"sv,
                "is compressed with xz; decompress it first"},
      Signature{"\x28\xB5\x2F\xFD"sv, "is compressed with zstd; decompress it first"},
      Signature{"7z\xBC\xAF\x27\x1C"sv, "is a 7z archive; extract it first"},
      Signature{"PK\x03\x04"sv, "is a ZIP archive, as 3MF is; extract or convert it first"},
  };
  if (is_utf16(bytes)) throw Error("this is UTF-16 text; save it as UTF-8");
  for (const Signature& signature : kSignatures)
    if (bytes.starts_with(signature.begin)) throw Error(std::string(signature.fault));
}

}  // namespace sdm::io
