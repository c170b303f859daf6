#include "io/mesh/gltf/document/gltf_uri.h"

#include <sdm/error.h>

#include <charconv>
#include <cstdint>
#include <memory>
#include <string>

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

}  // namespace sdm::io
