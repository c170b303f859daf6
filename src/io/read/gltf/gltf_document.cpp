#include "io/read/gltf/gltf_document.h"

#include <fmt/format.h>
#include <sdm/error.h>
#include <sdm/types.h>

#include <algorithm>
#include <charconv>
#include <limits>

#include "core/memory.h"
#include "io/read/byte_scanner.h"

namespace sdm::io {
namespace {

using nlohmann::json;

struct Chunks {
  std::string_view json;
  std::optional<std::string_view> binary;
};

// GLB: magic, version and length, then chunks, each with its length, type and data.
Chunks split(std::string_view bytes) {
  if (!bytes.starts_with("glTF")) return {bytes, std::nullopt};
  ByteScanner in(bytes);
  in.take(4);
  if (const auto version = in.number<std::uint32_t>(); version != 2)
    throw Error(fmt::format("glTF version {} is not supported, only version 2", version));
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

FileBytes decode_base64(std::string_view text) {
  const auto digit = [](char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    if (c == '+' || c == '-') return 62;
    if (c == '/' || c == '_') return 63;
    throw Error("an embedded buffer is not valid base64");
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

// Decodes escape sequences such as %20.
std::string decode_percent(std::string_view uri) {
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

FileBytes read_uri(const std::string& uri, const std::filesystem::path& folder) {
  if (uri.starts_with("data:")) {
    const std::size_t comma = uri.find(";base64,");
    if (comma == std::string::npos) throw Error("an embedded buffer is not base64");
    return decode_base64(std::string_view(uri).substr(comma + 8));
  }
  try {
    return read_bytes(folder / decode_percent(uri));
  } catch (const Error& fault) {
    throw Error(fmt::format("buffer '{}': {}", decode_percent(uri), fault.what()));
  }
}

std::size_t column_count(const std::string& type) {
  constexpr std::pair<std::string_view, std::size_t> types[] = {
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}};
  for (const auto& [name, columns] : types)
    if (type == name) return columns;
  throw Error(fmt::format("an accessor has type {} where numbers or vectors are needed", type.substr(0, 32)));
}

// Calls visit with a zero of the type with this glTF component code.
template <typename Visit>
auto with_component_type(std::size_t code, const Visit& visit) {
  switch (code) {
    case 5120:
      return visit(std::int8_t{});
    case 5121:
      return visit(std::uint8_t{});
    case 5122:
      return visit(std::int16_t{});
    case 5123:
      return visit(std::uint16_t{});
    case 5125:
      return visit(std::uint32_t{});
    case 5126:
      return visit(float{});
    default:
      throw Error(fmt::format("component type {} does not exist in glTF", code));
  }
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
  if (object.contains(name))
    for (const json& value : object.at(name)) numbers.push_back(checked(value, name));
  return numbers;
}

GltfDocument::GltfDocument(std::string_view bytes, const std::filesystem::path& folder) {
  const Chunks chunks = split(bytes);
  try {
    root_ = json::parse(chunks.json);
  } catch (const json::parse_error& fault) {
    throw Error(fmt::format("invalid JSON at byte {}; the file is truncated or damaged", fault.byte));
  }
  if (!root_.is_object() || !root_.contains("asset"))
    throw Error("this is JSON but not glTF: the member asset is missing");
  if (root_["asset"].at("version").get<std::string>().substr(0, 2) != "2.")
    throw Error("only glTF version 2 is supported");
  for (const json& extension : root_.value("extensionsRequired", json::array()))
    if (extension == "KHR_draco_mesh_compression" || extension == "EXT_meshopt_compression")
      throw Error(fmt::format("compressed with {}, which is not supported; save it uncompressed",
                              extension.get<std::string>()));
  load_buffers(chunks.binary, folder);
}

void GltfDocument::load_buffers(std::optional<std::string_view> binary_chunk,
                                const std::filesystem::path& folder) {
  for (const json& buffer : root_.value("buffers", json::array())) {
    if (buffer.contains("uri")) {
      files_.push_back(read_uri(buffer["uri"], folder));
      buffers_.push_back(files_.back().view());
    } else {
      buffers_.push_back(buffers_.empty() ? binary_chunk.value_or("") : "");
    }
    const std::size_t length = whole_number(buffer, "byteLength");
    if (length > buffers_.back().size())
      throw Error(fmt::format("buffer {} should have {} bytes but has {}; it is truncated or missing",
                              buffers_.size() - 1, length, buffers_.back().size()));
  }
}

const json& GltfDocument::item(const char* list, std::size_t index) const {
  const auto items = root_.find(list);
  if (items == root_.end() || !items->is_array() || index >= items->size())
    throw Error(fmt::format("item {} of {} is referred to but does not exist", index, list));
  return (*items)[index];
}

std::vector<double> GltfDocument::rows_of(const json& place, std::size_t component_type, bool normalized,
                                          std::size_t rows, std::size_t columns) const {
  const json& view = item("bufferViews", whole_number(place, "bufferView"));
  const std::size_t buffer = whole_number(view, "buffer");
  if (buffer >= buffers_.size())
    throw Error(fmt::format("buffer {} is referred to but does not exist", buffer));
  const std::size_t view_begin = whole_number(view, "byteOffset", 0),
                    view_length = whole_number(view, "byteLength");
  if (view_begin > buffers_[buffer].size() || view_length > buffers_[buffer].size() - view_begin)
    throw Error("a buffer view extends beyond its buffer");
  const std::string_view bytes = buffers_[buffer].substr(view_begin, view_length);

  std::vector<double> values;
  const std::size_t begin = whole_number(place, "byteOffset", 0);
  with_component_type(component_type, [&](auto zero) {
    using Component = decltype(zero);
    const std::size_t row_bytes = columns * sizeof(Component),
                      stride = whole_number(view, "byteStride", row_bytes);
    // The first row must fit, and each of the others lies `stride` bytes further.
    if (rows > 0 && (begin > bytes.size() || row_bytes > bytes.size() - begin || stride == 0 ||
                     rows - 1 > (bytes.size() - begin - row_bytes) / stride))
      throw Error("an accessor extends beyond its buffer view");
    const bool divide = normalized && std::numeric_limits<Component>::is_integer;
    values.reserve(rows * columns);
    for (std::size_t r = 0; r < rows; ++r)
      for (std::size_t c = 0; c < columns; ++c) {
        const double value = load<Component>(bytes.data() + begin + r * stride + c * sizeof(Component));
        // The smallest signed integer also represents −1.
        values.push_back(
            divide ? std::max(value / static_cast<double>(std::numeric_limits<Component>::max()), -1.0)
                   : value);
      }
  });
  return values;
}

GltfNumbers GltfDocument::numbers(std::size_t accessor_index) const {
  const json& accessor = item("accessors", accessor_index);
  GltfNumbers numbers{column_count(accessor.at("type")), {}};
  const std::size_t rows = whole_number(accessor, "count"),
                    component_type = whole_number(accessor, "componentType");
  const bool normalized = accessor.value("normalized", false);
  if (accessor.contains("bufferView") || !accessor.contains("sparse")) {
    numbers.values = rows_of(accessor, component_type, normalized, rows, numbers.columns);
  } else {  // zeros, which take no space in the file
    if (rows >= kNone) throw Error("an accessor has more than 2^32 rows");
    require_memory(rows * numbers.columns * sizeof(double), "an accessor");
    numbers.values.resize(rows * numbers.columns);
  }
  if (accessor.contains("sparse")) {
    const json& sparse = accessor["sparse"];
    const std::size_t count = whole_number(sparse, "count");
    const json& places = sparse.at("indices");
    const std::vector<double> indices =
        rows_of(places, whole_number(places, "componentType"), false, count, 1);
    const std::vector<double> values =
        rows_of(sparse.at("values"), component_type, normalized, count, numbers.columns);
    for (std::size_t i = 0; i < count; ++i) {
      if (!(indices[i] >= 0 && indices[i] < static_cast<double>(rows)))
        throw Error("a sparse accessor replaces a row beyond its last one");
      std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(i * numbers.columns), numbers.columns,
                  numbers.values.begin() +
                      static_cast<std::ptrdiff_t>(static_cast<std::size_t>(indices[i]) * numbers.columns));
    }
  }
  return numbers;
}

void throw_gltf_fault(const json::exception& fault) {
  // The library's messages begin with a code in brackets.
  const std::string text = fault.what();
  throw Error(fmt::format("invalid glTF: {}", text.substr(std::min(text.size(), text.find("] ") + 2))));
}

}  // namespace sdm::io
