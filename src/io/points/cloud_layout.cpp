#include "io/points/cloud_layout.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

#include "io/points/text_numbers.h"
#include "io/read/byte_scanner.h"

namespace sdm::io {
namespace {

using Type = PlyHeader::Type;

/// The fields of a row, in order.
struct Field {
  std::string_view name;
  Type type;
  std::size_t count = 1;
};

CloudLayout layout_of(const std::vector<Field>& fields, bool text, const char* format) {
  CloudLayout layout;
  layout.text = text;
  constexpr std::string_view names[6][2] = {{"x", "X"},         {"y", "Y"},         {"z", "Z"},
                                            {"nx", "normal_x"}, {"ny", "normal_y"}, {"nz", "normal_z"}};
  std::array<bool, 6> found{};
  for (const Field& field : fields) {
    for (std::size_t k = 0; k < 6; ++k)
      if (!found[k] && field.count == 1 && std::ranges::count(names[k], field.name) > 0)
        found[k] = true, layout.columns[k] = {layout.stride, field.type};
    layout.stride += field.count * (text ? 1 : size_of(field.type));
  }
  if (!found[0] || !found[1] || !found[2])
    throw Error(fmt::format("the {} has no fields x, y and z", format));
  layout.has_normals = found[3] && found[4] && found[5];
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
  CloudLayout layout = layout_of(fields, header.encoding == PlyHeader::Encoding::text, "PLY file");
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
    if (size == 8) return Type::float64;  // only its size counts: coordinates are checked
  }
  throw Error("the PCD header has a field of a type that does not exist");
}

CloudLayout pcd_layout(std::string_view bytes) {
  std::vector<std::string_view> names, kinds;
  std::vector<std::uint64_t> sizes, counts;
  std::optional<std::uint64_t> points, width, height;
  std::string_view data;
  std::size_t at = 0;
  while (data.empty()) {
    const std::size_t end = bytes.find('\n', at);
    if (end == std::string_view::npos) throw Error("the PCD header has no line DATA");
    std::string_view line = bytes.substr(at, end - at);
    at = end + 1;
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
    const bool coordinate = names[i] == "x" || names[i] == "y" || names[i] == "z";
    if (coordinate && (kinds[i] != "F" || counts[i] != 1))
      throw Error(fmt::format("the field {} of the PCD file is not one number of type F", names[i]));
    fields.push_back({names[i], pcd_type(kinds[i].empty() ? ' ' : kinds[i][0], sizes[i]), counts[i]});
  }
  CloudLayout layout = layout_of(fields, data == "ascii", "PCD file");
  layout.data_begin = at;
  layout.compressed = data == "binary_compressed";
  if (points)
    layout.count = points;
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
  CloudLayout layout;
  layout.has_scale = true;
  layout.data_begin = at(96, std::uint32_t{});
  layout.stride = at(105, std::uint16_t{});
  layout.count = at(107, std::uint32_t{});
  if (minor >= 4) layout.count = at(247, std::uint64_t{});
  if (layout.stride < 20 || layout.data_begin < kHeader)
    throw Error("the header of the LAS file has impossible sizes; it is damaged");
  for (std::size_t k = 0; k < 3; ++k) {
    layout.columns[k] = {4 * k, Type::int32};
    layout.scale[k] = at(131 + 8 * k, double{}), layout.offset[k] = at(155 + 8 * k, double{});
    if (!std::isfinite(layout.scale[k]) || !std::isfinite(layout.offset[k]) || layout.scale[k] == 0)
      throw Error("the scale or the offset in the header of the LAS file is zero or not a number");
  }
  return layout;
}

/// The first lines show how many columns there are, and whether three of them are normals.
CloudLayout xyz_layout(std::string_view bytes) {
  constexpr std::size_t kLines = 1000;
  constexpr double kLength = 0.01;
  CloudLayout layout;
  layout.text = true;
  layout.fixed_columns = false;
  layout.stride = 3;
  std::size_t rows = 0, unit = 0;
  std::vector<double> numbers;
  const bool whole = bytes.size() < kMaxCloudHeader;
  while (rows < kLines && !bytes.empty()) {
    const std::size_t end = bytes.find('\n');
    if (end == std::string_view::npos && !whole) break;  // the line may be cut
    const std::string_view line = bytes.substr(0, end);
    bytes.remove_prefix(end == std::string_view::npos ? bytes.size() : end + 1);
    if (!numbers_of(line, numbers) || numbers.size() < 3) continue;
    ++rows;
    unit += numbers.size() >= 6 && std::abs(std::hypot(numbers[3], numbers[4], numbers[5]) - 1) < kLength;
  }
  if (rows == 0)
    throw Error(
        "unknown format; PLY, PCD, LAS and text with three or more numbers a line (XYZ) are supported");
  layout.has_normals = unit == rows;
  if (layout.has_normals) layout.stride = 6;
  for (std::size_t k = 0; k < layout.stride; ++k) layout.columns[k].place = k;
  return layout;
}

bool is_pcd(std::string_view bytes) {
  while (bytes.starts_with('#')) bytes.remove_prefix(std::min(bytes.find('\n'), bytes.size() - 1) + 1);
  return bytes.starts_with("VERSION") || bytes.starts_with("FIELDS");
}

}  // namespace

CloudLayout cloud_layout(std::string_view bytes) {
  if (bytes.empty()) throw Error("the file is empty");
  if (bytes.starts_with("LASF")) return las_layout(bytes);
  if (bytes.starts_with("ply\n") || bytes.starts_with("ply\r")) return ply_layout(bytes);
  if (is_pcd(bytes)) return pcd_layout(bytes);
  return xyz_layout(bytes);
}

}  // namespace sdm::io
