// The buffers of a glTF file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/file/file_bytes.h"

namespace sdm::io {

/// Decodes escape sequences such as %20, once: what they stand for is not decoded again.
[[nodiscard]] std::string decode_uri(std::string_view uri);

/// Returns whether the URI contains its data.
[[nodiscard]] bool is_data_uri(std::string_view uri);

/// Returns the data of such a URI. Throws sdm::Error unless they are base64.
[[nodiscard]] FileBytes decode_data_uri(std::string_view uri);

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
