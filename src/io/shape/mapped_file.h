// A file as memory, without copying it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>

namespace sdm::io {

/// Bytes at an address that is a multiple of 64. They may be changed, which does not change the file.
struct MappedFile {
  std::span<std::byte> bytes;
  std::shared_ptr<const void> owner;  ///< ends the mapping
};

/// Maps a regular file, or reads it where systems have no such mappings. Throws sdm::Error; the message does
/// not name the file. `kind`: of files, for the message: "shape".
[[nodiscard]] MappedFile map_file(const std::filesystem::path& file, std::string_view kind);

}  // namespace sdm::io
