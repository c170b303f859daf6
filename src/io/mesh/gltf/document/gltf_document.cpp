#include "io/mesh/gltf/document/gltf_document.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>

#include "core/excerpt.h"
#include "core/memory.h"
#include "io/file/byte_scanner.h"
#include "io/mesh/gltf/document/gltf_extensions.h"
#include "io/mesh/gltf/document/gltf_rows.h"

namespace sdm::io {
namespace {

using nlohmann::json;

struct Chunks {
  std::string_view json;
  std::optional<std::string_view> binary;
};

[[noreturn]] void refuse_version(std::string_view version) {
  throw Error(fmt::format("glTF version {} is not supported, only version 2; convert it to glTF 2.0",
                          excerpt(version)));
}

// GLB: magic, version and length, then chunks, each with its length, type and data.
Chunks split(std::string_view bytes) {
  if (!bytes.starts_with("glTF")) return {bytes, std::nullopt};
  ByteScanner in(bytes);
  in.take(4);
  if (const auto version = in.number<std::uint32_t>(); version != 2) refuse_version(fmt::to_string(version));
  if (in.number<std::uint32_t>() > bytes.size()) throw Error("the GLB file is truncated");
  Chunks chunks;
  while (in.remaining() >= 8) {
    const auto length = in.number<std::uint32_t>();
    const std::string_view kind = in.take(4), data = in.take(length);
    if (kind == "JSON" && chunks.json.empty()) chunks.json = data;
    if (kind == std::string_view("BIN\0", 4) && !chunks.binary) chunks.binary = data;
  }
  return chunks;
}

// The version could be a number or missing in glTF 1.0, where meshes were members of an object.
void check_version(const json& root) {
  if (const auto meshes = root.find("meshes"); meshes != root.end() && meshes->is_object())
    refuse_version("1.0");
  const auto asset = root.find("asset");
  if (asset == root.end()) throw Error("this is JSON but not glTF: the member asset is missing");
  const json& version = asset->at("version");
  if (version.is_number() && version.get<double>() < 2) refuse_version(version.dump());
  const auto& text = text_of(version, "the version");
  if (!text.starts_with("2.")) refuse_version(text);
  if (const auto least = asset->find("minVersion"); least != asset->end() && *least != "2.0")
    refuse_version(text_of(*least, "minVersion"));
}

// Converting negative, fractional or too large numbers would be undefined.
std::size_t checked(const json& value, const char* name) {
  if (!value.is_number_unsigned())
    throw Error(fmt::format("{} must be a whole number that is not negative", name));
  return value.get<std::size_t>();
}

}  // namespace

std::size_t whole_number(const json& object, const char* name) {
  return checked(object.at(name), name);
}

std::size_t whole_number(const json& object, const char* name, std::size_t otherwise) {
  return object.contains(name) ? whole_number(object, name) : otherwise;
}

std::vector<std::size_t> whole_numbers(const json& object, const char* name) {
  std::vector<std::size_t> numbers;
  for (const json& value : list_of(object, name)) numbers.push_back(checked(value, name));
  return numbers;
}

const json& list_of(const json& object, const char* name) {
  static const json kEmpty = json::array();
  const auto list = object.find(name);
  if (list == object.end()) return kEmpty;
  if (!list->is_array()) throw Error(fmt::format("invalid glTF: {} is not a list", name));
  return *list;
}

const std::string& text_of(const json& value, const char* name) {
  if (!value.is_string()) throw Error(fmt::format("invalid glTF: {} is not text", name));
  return value.get_ref<const std::string&>();
}

GltfDocument::GltfDocument(std::string_view bytes, const std::filesystem::path& folder) {
  const Chunks chunks = split(bytes);
  try {
    root_ = json::parse(chunks.json);
  } catch (const json::parse_error& fault) {
    throw Error(fmt::format("invalid JSON at byte {}; the file is truncated or damaged", fault.byte));
  }
  if (!root_.is_object()) throw Error("this is JSON but not glTF: the member asset is missing");
  check_version(root_);
  check_required_extensions(root_);
  buffers_ = GltfBuffers(list_of(root_, "buffers"), chunks.binary, folder);
  file_bytes_ = bytes.size() + buffers_.size();
}

const json& GltfDocument::item(const char* list, std::size_t index) const {
  const auto items = root_.find(list);
  if (items == root_.end() || !items->is_array() || index >= items->size())
    throw Error(fmt::format("item {} of {} is referred to but does not exist", index, list));
  return (*items)[index];
}

std::string_view GltfDocument::view(std::size_t index) const {
  const json& view = item("bufferViews", index);
  const std::string_view buffer = buffers_[whole_number(view, "buffer")];
  const std::size_t begin = whole_number(view, "byteOffset", 0), length = whole_number(view, "byteLength");
  if (begin <= buffer.size() && length <= buffer.size() - begin) return buffer.substr(begin, length);
  if (const std::string_view extension = gltf_compression(view); !extension.empty())
    refuse_compressed(extension);
  throw Error("a buffer view extends beyond its buffer");
}

std::vector<double> GltfDocument::numbers(std::size_t accessor) const {
  const GltfRows rows(*this, accessor);
  charge(rows.rows() > SIZE_MAX / (rows.columns() * sizeof(double))
             ? SIZE_MAX
             : rows.rows() * rows.columns() * sizeof(double),
         "an accessor");
  std::vector<double> numbers;
  numbers.reserve(rows.rows() * rows.columns());
  for (std::size_t r = 0; r < rows.rows(); ++r)
    for (std::size_t c = 0; c < rows.columns(); ++c) numbers.push_back(rows.number(r, c));
  return numbers;
}

void GltfDocument::charge(std::size_t bytes, std::string_view purpose) const {
  constexpr std::size_t kFree = std::size_t{64} << 20, kPerByte = 4096;
  const std::size_t limit = kFree + kPerByte * file_bytes_;  // cannot overflow: the files are in memory
  if (bytes > limit - charged_)
    throw Error(fmt::format(
        "{} would take {:.3g} GB of memory, but a file of {} bytes may take {:.3g} GB; save "
        "it with fewer copies of its meshes",
        purpose, static_cast<double>(bytes) / 1e9, file_bytes_, static_cast<double>(limit) / 1e9));
  charged_ += bytes;
  // Asking the system for every node would take longer than reading it.
  constexpr std::size_t kUnchecked = std::size_t{16} << 20;
  if (charged_ - checked_ < kUnchecked) return;
  require_memory(charged_ - checked_, purpose);
  checked_ = charged_;
}

void throw_gltf_fault(const json::exception& fault) {
  // The library's messages begin with a code in brackets.
  const std::string text = fault.what();
  throw Error(
      fmt::format("invalid glTF: {}", excerpt(text.substr(std::min(text.size(), text.find("] ") + 2)), 200)));
}

}  // namespace sdm::io
