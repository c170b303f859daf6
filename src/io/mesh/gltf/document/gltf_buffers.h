// The buffers of a glTF file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "io/file/file_bytes.h"

namespace sdm::io {

/// The bytes of all buffers. A file that several buffers refer to is read once.
class GltfBuffers {
 public:
  GltfBuffers() = default;
  /// Loads a list of buffers. `binary_chunk`: that of the GLB file, if any, which must outlive this object.
  /// Throws sdm::Error for a file that is refused (file_below) or cannot be read.
  GltfBuffers(const nlohmann::json& buffers, std::optional<std::string_view> binary_chunk,
              const std::filesystem::path& folder);

  /// Throws if there is no such buffer.
  [[nodiscard]] std::string_view operator[](std::size_t buffer) const;
  /// Bytes that are held.
  [[nodiscard]] std::size_t size() const;

 private:
  std::vector<FileBytes> held_;
  std::vector<std::string_view> buffers_;
};

}  // namespace sdm::io
