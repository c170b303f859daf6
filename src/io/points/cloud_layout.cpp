#include "io/points/cloud_layout.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

#include "io/file/byte_scanner.h"
#include "io/mesh/ply_header.h"
#include "io/points/text/column_names.h"
#include "io/points/text/text_lines.h"

namespace sdm::io {
namespace {

using Type = NumberType;

/// The fields of a row, in order.
struct Field {
  std::string_view name;
  Type type;
  std::size_t count = 1;
};

CloudLayout layout_of(const std::vector<Field>& fields, bool text, std::string_view format) {
  CloudLayout layout{.format = format, .text = text};
  std::vector<std::string_view> names;
  std::vector<CloudColumn> columns;
  for (const Field& field : fields) {
    names.push_back(field.count == 1 ? field.name : std::string_view());
    columns.push_back({layout.stride, field.type});
    layout.stride += field.count * (text ? 1 : size_of(field.type));
  }
  const auto named = named_columns(names);
  if (!named) throw Error(fmt::format("the {} file has no fields x, y and z of one number each", format));
  layout.has_normals = named->has_normals;
  for (std::size_t k = 0; k < (layout.has_normals ? kRoles : 3); ++k)
    layout.columns[k] = columns[named->columns[k]];
  return layout;
}

CloudLayout ply_layout(std::string_view bytes) {
  const PlyHeader header = parse_ply_header(bytes);
  const auto element = std::ranges::find_if(header.elements, [](const auto& e) { return e.count > 0; });
  if (element == header.elements.end() || element->name != "vertex")
    throw Error(std::ranges::count(header.elements, "vertex", &PlyHeader::Element::name) == 0 ||
                        element == header.elements.end()
                    ? "the PLY file has no vertices"
                    : fmt::format("element {} precedes the vertices of the PLY file; save them first",
                                  element->name.substr(0, 32)));
  std::vector<Field> fields;
  for (const PlyHeader::Property& property : element->properties) {
    if (property.count_type) throw Error("the vertices of the PLY file have a list; save them without it");
    fields.push_back({property.name, property.type});
  }
  CloudLayout layout = layout_of(fields, header.encoding == PlyHeader::Encoding::text, "PLY");
  if (header.encoding == PlyHeader::Encoding::big_endian) layout.order = std::endian::big;
  layout.data_begin = header.size;
  layout.count = element->count;
  return layout;
}

std::string_view next_word(std::string_view& text) {
  constexpr std::string_view kBlanks = " \t\r";
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(kBlanks));
  text.remove_prefix(word.size());
  return word;
}

std::uint64_t whole_number(std::string_view word, std::string_view key) {
  std::uint64_t value = 0;
  const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (fault != std::errc() || end != word.data() + word.size())
    throw Error(fmt::format("the value of {} in the PCD header is not a whole number", key));
  return value;
}

Type pcd_type(char kind, std::uint64_t size) {
  if (kind == 'F' && size == 4) return Type::float32;
  if (kind == 'F' && size == 8) return Type::float64;
  if (kind == 'I' || kind == 'U') {
    const bool has_sign = kind == 'I';
    if (size == 1) return has_sign ? Type::int8 : Type::uint8;
    if (size == 2) return has_sign ? Type::int16 : Type::uint16;
    if (size == 4) return has_sign ? Type::int32 : Type::uint32;
    if (size == 8) return has_sign ? Type::int64 : Type::uint64;
  }
  throw Error("the PCD header has a field of a type that does not exist");
}

CloudLayout pcd_layout(std::string_view bytes) {
  std::vector<std::string_view> names, kinds;
  std::vector<std::uint64_t> sizes, counts;
  std::optional<std::uint64_t> points, width, height;
  std::string_view data;
  const std::size_t size = bytes.size();
  const char line_end = line_end_of(bytes);
  while (data.empty()) {
    if (bytes.find(line_end) == std::string_view::npos) throw Error("the PCD header has no line DATA");
    std::string_view line = take_line(bytes, line_end);
    const std::string_view key = next_word(line);
    const auto values = [&](auto& list, const auto& convert) {
      for (std::string_view word; !(word = next_word(line)).empty();) list.push_back(convert(word));
    };
    const auto number = [&](std::string_view word) { return whole_number(word, key); };
    const auto same = [](std::string_view word) { return word; };
    if (key == "FIELDS") values(names, same);
    if (key == "TYPE") values(kinds, same);
    if (key == "SIZE") values(sizes, number);
    if (key == "COUNT") values(counts, number);
    if (key == "POINTS") points = number(next_word(line));
    if (key == "WIDTH") width = number(next_word(line));
    if (key == "HEIGHT") height = number(next_word(line));
    if (key == "DATA") data = next_word(line);
  }
  if (data != "ascii" && data != "binary" && data != "binary_compressed")
    throw Error("the data of the PCD file are neither ascii, binary nor binary_compressed");
  if (counts.empty()) counts.assign(names.size(), 1);
  if (names.empty() || sizes.size() != names.size() || kinds.size() != names.size() ||
      counts.size() != names.size())
    throw Error("FIELDS, SIZE, TYPE and COUNT of the PCD header have different numbers of values");
  std::vector<Field> fields;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (counts[i] > kMaxCloudHeader) throw Error("the PCD header has a field of too many values");
    fields.push_back({names[i], pcd_type(kinds[i].empty() ? ' ' : kinds[i][0], sizes[i]), counts[i]});
  }
  CloudLayout layout = layout_of(fields, data == "ascii", "PCD");
  layout.data_begin = size - bytes.size();
  layout.compressed = data == "binary_compressed";
  if (points)
    layout.count = *points;
  else if (width && height && (*height == 0 || *width <= UINT64_MAX / *height))
    layout.count = *width * *height;
  else
    throw Error("the PCD header has no number of points");
  return layout;
}

/// ASPRS LAS 1.0 to 1.4. LAZ has the same header, with a bit set in the record format.
CloudLayout las_layout(std::string_view bytes) {
  constexpr std::size_t kHeader = 227, kHeader14 = 375;  // bytes
  const auto at = [&]<class T>(std::size_t place, T) {
    return load<T>(bytes.data() + place, std::endian::little);
  };
  const auto minor = bytes.size() > 25 ? static_cast<unsigned char>(bytes[25]) : 0u;
  if (bytes.size() < (minor >= 4 ? kHeader14 : kHeader)) throw Error("the header of the LAS file is cut off");
  const auto format = static_cast<unsigned char>(bytes[104]);
  if (format >= 64)
    throw Error("LAZ, compressed LAS, is not supported; convert the cloud to LAS, for example with laszip");
  if (bytes[24] != 1 || minor > 4 || format > 10)
    throw Error("the LAS file is of a version or a point format that does not exist up to LAS 1.4");
  CloudLayout layout{.format = "LAS"};
  layout.has_scale = true;
  layout.data_begin = at(96, std::uint32_t{});
  layout.stride = at(105, std::uint16_t{});
  layout.count = at(107, std::uint32_t{});
  if (minor >= 4) layout.count = at(247, std::uint64_t{});
  if (layout.stride < 20 || layout.data_begin < kHeader)
    throw Error("the header of the LAS file has impossible sizes; it is damaged");
  for (std::size_t k = 0; k < 3; ++k) {
    layout.columns[k] = {4 * k, Type::int32};
    layout.scale[k] = at(131 + 8 * k, double{});
    layout.offset[k] = at(155 + 8 * k, double{});
    if (!std::isfinite(layout.scale[k]) || !std::isfinite(layout.offset[k]) || layout.scale[k] == 0)
      throw Error("the scale or the offset in the header of the LAS file is zero or not a number");
  }
  return layout;
}

bool is_pcd(std::string_view bytes) {
  const char line_end = line_end_of(bytes);
  while (bytes.starts_with('#')) (void)take_line(bytes, line_end);
  return bytes.starts_with("VERSION") || bytes.starts_with("FIELDS");
}

}  // namespace

std::optional<CloudLayout> cloud_layout(std::string_view bytes) {
  if (bytes.starts_with("ASTM-E57"))
    throw Error("E57 is not supported; convert the cloud to LAS or PLY, for example with CloudCompare");
  if (bytes.starts_with("LASF")) return las_layout(bytes);
  if (bytes.starts_with("ply\n") || bytes.starts_with("ply\r") || bytes.starts_with("ply "))
    return ply_layout(bytes);
  if (is_pcd(bytes)) return pcd_layout(bytes);
  return std::nullopt;
}

}  // namespace sdm::io
