// A file in memory.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string_view>

namespace sdm::io {

struct FileBytes {
  std::unique_ptr<char[]> data;
  std::size_t size = 0;

  [[nodiscard]] std::string_view view() const { return {data.get(), size}; }
};

/// Reads a regular file, after checking that there is enough memory for it and for the mesh built from it.
/// Throws sdm::Error; the message does not name the file.
[[nodiscard]] FileBytes read_bytes(const std::filesystem::path& file);

}  // namespace sdm::io
