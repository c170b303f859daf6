// A file in memory.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string_view>

namespace sdm::core {
class Checksum;
}

namespace sdm::io {

struct FileBytes {
  std::unique_ptr<char[]> data;
  std::size_t size = 0;

  [[nodiscard]] std::string_view view() const { return {data.get(), size}; }
};

/// Throws sdm::Error unless it is a regular file; the message does not name the file. `kind`: of files, for
/// the message: "mesh".
void require_regular_file(const std::filesystem::path& file, std::string_view kind);

/// Reads a regular file, after checking that there is enough memory for it and for the mesh built from it.
/// Throws sdm::Error; the message does not name the file.
[[nodiscard]] FileBytes read_bytes(const std::filesystem::path& file);

/// Adds the bytes of a file. Throws sdm::Error if it cannot be read.
void add_file(core::Checksum& checksum, const std::filesystem::path& file);

}  // namespace sdm::io
