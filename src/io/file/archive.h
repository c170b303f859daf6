// Recognises files that are compressed as a whole.
#pragma once

#include <sdm/error.h>

#include <array>
#include <string>
#include <string_view>

namespace sdm::io {

/// Throws sdm::Error if the bytes begin like an archive or a compressed file, whose content is not read.
/// Cost: O(1).
inline void refuse_archive(std::string_view bytes) {
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
  for (const Signature& signature : kSignatures)
    if (bytes.starts_with(signature.begin)) throw Error(std::string(signature.fault));
}

}  // namespace sdm::io
