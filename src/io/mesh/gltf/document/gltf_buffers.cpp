#include "io/mesh/gltf/document/gltf_buffers.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "core/excerpt.h"
#include "io/file/file_below.h"
#include "io/mesh/gltf/document/gltf_document.h"
#include "io/mesh/gltf/document/gltf_extensions.h"
#include "io/mesh/gltf/document/gltf_uri.h"

namespace sdm::io {
namespace {

using nlohmann::json;

FileBytes read_buffer(const std::filesystem::path& file, std::string_view uri) {
  try {
    return read_bytes(file);
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& fault) {
    throw Error(fmt::format("buffer '{}': {}", excerpt(decode_uri(uri)), fault.what()));
  }
}

}  // namespace

GltfBuffers::GltfBuffers(const json& buffers, std::optional<std::string_view> binary_chunk,
                         const std::filesystem::path& folder) {
  std::map<std::filesystem::path, std::string_view> files;
  for (const json& buffer : buffers) {
    if (const auto uri = buffer.find("uri"); uri == buffer.end()) {
      buffers_.push_back(buffers_.empty() ? binary_chunk.value_or("") : "");
      // Stands for what is compressed elsewhere; buffer views that need it are refused.
      if (buffers_.back().empty() && !gltf_compression(buffer).empty()) continue;
    } else if (const std::string& text = text_of(*uri, "the URI of a buffer"); is_data_uri(text)) {
      buffers_.push_back(held_.emplace_back(decode_data_uri(text)).view());
    } else {
      const auto [file, is_new] = files.try_emplace(file_below(folder, decode_uri(text), "buffer"));
      if (is_new) file->second = held_.emplace_back(read_buffer(file->first, text)).view();
      buffers_.push_back(file->second);
    }
    const std::size_t length = whole_number(buffer, "byteLength");
    if (length > buffers_.back().size())
      throw Error(fmt::format("buffer {} should have {} bytes but has {}; it is truncated or missing",
                              buffers_.size() - 1, length, buffers_.back().size()));
  }
}

std::string_view GltfBuffers::operator[](std::size_t buffer) const {
  if (buffer >= buffers_.size())
    throw Error(fmt::format("buffer {} is referred to but does not exist", buffer));
  return buffers_[buffer];
}

std::size_t GltfBuffers::size() const {
  std::size_t bytes = 0;
  for (const FileBytes& held : held_) bytes += held.size;
  return bytes;
}

}  // namespace sdm::io
