#include "io/mesh/gltf/document/gltf_buffers.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <charconv>
#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "core/excerpt.h"
#include "io/file/file_below.h"
#include "io/mesh/gltf/document/gltf_document.h"
#include "io/mesh/gltf/document/gltf_extensions.h"

namespace sdm::io {
namespace {

FileBytes decode_base64(std::string_view text) {
  const auto digit = [](char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    if (c == '+' || c == '-') return 62;
    if (c == '/' || c == '_') return 63;
    throw Error("embedded data are not valid base64");
  };
  while (text.ends_with('=')) text.remove_suffix(1);
  FileBytes bytes;
  bytes.size = text.size() * 3 / 4;
  bytes.data = std::make_unique_for_overwrite<char[]>(bytes.size + 1);
  std::uint32_t bits = 0;
  for (std::size_t i = 0, out = 0; i < text.size(); ++i) {
    bits = bits << 6 | static_cast<std::uint32_t>(digit(text[i]));
    if (i % 4 != 0) bytes.data[out++] = static_cast<char>(bits >> (6 - 2 * (i % 4)) & 0xFF);
  }
  return bytes;
}

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

std::string decode_uri(std::string_view uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    unsigned char code = 0;
    if (uri[i] == '%' && i + 2 < uri.size() &&
        std::from_chars(uri.data() + i + 1, uri.data() + i + 3, code, 16).ptr == uri.data() + i + 3) {
      text += static_cast<char>(code);
      i += 2;
    } else {
      text += uri[i];
    }
  }
  return text;
}

bool is_data_uri(std::string_view uri) {
  return uri.starts_with("data:");
}

FileBytes decode_data_uri(std::string_view uri) {
  constexpr std::string_view kBase64 = ";base64,";
  const std::size_t comma = uri.find(kBase64);
  if (comma == std::string_view::npos) throw Error("embedded data are not base64");
  return decode_base64(uri.substr(comma + kBase64.size()));
}

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
