#include "io/mesh/gltf/document/gltf_rows.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>

#include "core/excerpt.h"
#include "io/file/byte_scanner.h"
#include "io/mesh/gltf/document/gltf_document.h"

namespace sdm::io {
namespace {

using nlohmann::json;

std::size_t column_count(const std::string& type) {
  constexpr std::pair<std::string_view, std::size_t> types[] = {
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
  for (const auto& [name, columns] : types)
    if (type == name) return columns;
  throw Error(fmt::format("an accessor has type {} where numbers, vectors or 4×4 matrices are needed",
                          excerpt(type)));
}

template <typename Component>
double load_number(const char* bytes) {
  return static_cast<double>(load<Component>(bytes));
}
template <typename Component>
double load_fraction(const char* bytes) {
  // The smallest signed integer also represents −1.
  return std::max(load_number<Component>(bytes) / static_cast<double>(std::numeric_limits<Component>::max()),
                  -1.0);
}

struct ComponentType {
  std::size_t code, bytes;
  double (*number)(const char*);
  double (*fraction)(const char*);
  bool indexes;  ///< may be the type of the indices of a sparse accessor
};

template <typename Component>
constexpr ComponentType integer(std::size_t code) {
  return {code, sizeof(Component), load_number<Component>, load_fraction<Component>,
          !std::numeric_limits<Component>::is_signed};
}

constexpr ComponentType kComponentTypes[] = {
    integer<std::int8_t>(5120),   integer<std::uint8_t>(5121),
    integer<std::int16_t>(5122),  integer<std::uint16_t>(5123),
    integer<std::uint32_t>(5125), {5126, sizeof(float), load_number<float>, load_number<float>, false}};

const ComponentType& component_type_of(std::size_t code) {
  for (const ComponentType& type : kComponentTypes)
    if (type.code == code) return type;
  throw Error(fmt::format("component type {} does not exist in glTF", code));
}

}  // namespace

GltfRows::Block GltfRows::block(const GltfDocument& document, const json& place, std::size_t component_type,
                                bool normalized, std::size_t rows, std::size_t columns) {
  const std::size_t view_index = whole_number(place, "bufferView");
  const json& view = document.item("bufferViews", view_index);
  const std::string_view bytes = document.view(view_index);

  const ComponentType& type = component_type_of(component_type);
  const std::size_t begin = whole_number(place, "byteOffset", 0), row_bytes = columns * type.bytes,
                    stride = whole_number(view, "byteStride", row_bytes);
  // The first row must fit, and each of the others lies `stride` bytes further.
  if (rows > 0 && (begin > bytes.size() || row_bytes > bytes.size() - begin || stride == 0 ||
                   rows - 1 > (bytes.size() - begin - row_bytes) / stride))
    throw Error("an accessor extends beyond its buffer view");
  static constexpr char kNothing = 0;  // of an empty view: never read
  return {rows > 0 ? bytes.data() + begin : &kNothing, stride, type.bytes,
          normalized ? type.fraction : type.number};
}

GltfRows::GltfRows(const GltfDocument& document, std::size_t accessor_index) {
  const json& accessor = document.item("accessors", accessor_index);
  rows_ = whole_number(accessor, "count");
  columns_ = column_count(text_of(accessor.at("type"), "the type of an accessor"));
  const std::size_t component_type = whole_number(accessor, "componentType");
  const bool normalized = accessor.value("normalized", false);
  const auto sparse = accessor.find("sparse");
  if (accessor.contains("bufferView"))
    base_ = block(document, accessor, component_type, normalized, rows_, columns_);
  else if (sparse == accessor.end())
    throw Error(
        fmt::format("accessor {} has no data, neither a buffer view nor a sparse part", accessor_index));
  if (sparse == accessor.end()) return;

  sparse_rows_ = whole_number(*sparse, "count");
  const json& places = sparse->at("indices");
  const std::size_t index_type = whole_number(places, "componentType");
  if (!component_type_of(index_type).indexes)
    throw Error("the indices of a sparse accessor are not unsigned integers");
  indices_ = block(document, places, index_type, false, sparse_rows_, 1);
  values_ = block(document, sparse->at("values"), component_type, normalized, sparse_rows_, columns_);
  for (std::size_t i = 0; i < sparse_rows_; ++i) {
    if (sparse_row(i) >= rows_) throw Error("a sparse accessor replaces a row beyond its last one");
    if (i > 0 && sparse_row(i) <= sparse_row(i - 1))
      throw Error("the indices of a sparse accessor do not increase");
  }
}

double GltfRows::number(std::size_t row, std::size_t column) const {
  if (sparse_rows_ > 0) {
    std::size_t first = 0;  // of the sparse rows that are not before `row`
    for (std::size_t count = sparse_rows_; count > 0;) {
      const std::size_t half = count / 2;
      if (sparse_row(first + half) < row) {
        first += half + 1;
        count -= half + 1;
      } else {
        count = half;
      }
    }
    if (first < sparse_rows_ && sparse_row(first) == row) return values_.number(first, column);
  }
  return base_.first ? base_.number(row, column) : 0;
}

}  // namespace sdm::io
