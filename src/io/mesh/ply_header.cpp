#include "io/mesh/ply_header.h"

#include <fmt/format.h>

#include "io/file/text_scanner.h"

namespace sdm::io {
namespace {

using Type = NumberType;

std::string parse_word(TextScanner& in) {
  if (!in.more_on_line()) in.fail("a word is missing in the PLY header");
  return std::string(in.word());
}

Type parse_type(TextScanner& in) {
  struct Spelling {
    std::string_view name;
    Type type;
  };
  constexpr Spelling spellings[] = {
      {"char", Type::int8},      {"uchar", Type::uint8},    {"short", Type::int16},
      {"ushort", Type::uint16},  {"int", Type::int32},      {"uint", Type::uint32},
      {"float", Type::float32},  {"double", Type::float64}, {"int8", Type::int8},
      {"uint8", Type::uint8},    {"int16", Type::int16},    {"uint16", Type::uint16},
      {"int32", Type::int32},    {"uint32", Type::uint32},  {"float32", Type::float32},
      {"float64", Type::float64}};
  if (in.more_on_line())
    for (const Spelling& spelling : spellings)
      if (in.accept(spelling.name)) return spelling.type;
  in.fail_at_word("expected a PLY type");
}

PlyHeader::Encoding parse_encoding(TextScanner& in) {
  if (in.more_on_line()) {
    if (in.accept("ascii")) return PlyHeader::Encoding::text;
    if (in.accept("binary_little_endian")) return PlyHeader::Encoding::little_endian;
    if (in.accept("binary_big_endian")) return PlyHeader::Encoding::big_endian;
  }
  in.fail_at_word("expected ascii, binary_little_endian or binary_big_endian");
}

PlyHeader::Element parse_element(TextScanner& in) {
  PlyHeader::Element element{parse_word(in), 0, {}};
  const std::int64_t count = in.integer();
  if (count < 0) in.fail(fmt::format("the count of element {} is negative", element.name));
  element.count = static_cast<std::size_t>(count);
  return element;
}

PlyHeader::Property parse_property(TextScanner& in) {
  PlyHeader::Property property{};
  if (in.more_on_line() && in.accept("list")) property.count_type = parse_type(in);
  property.type = parse_type(in);
  property.name = parse_word(in);
  return property;
}

}  // namespace

std::optional<std::size_t> PlyHeader::Element::find(std::initializer_list<std::string_view> names) const {
  for (const bool exact : {true, false})
    for (const std::string_view wanted : names)
      for (std::size_t p = 0; p < properties.size(); ++p)
        if (exact ? properties[p].name == wanted : same_word(properties[p].name, wanted)) return p;
  return std::nullopt;
}

PlyHeader parse_ply_header(std::string_view bytes) {
  TextScanner in(bytes);
  PlyHeader header;
  bool has_format = false;
  if (!in.accept("ply")) in.fail("a PLY file must begin with 'ply'");
  for (in.skip_line(); !in.at_end(); in.skip_line()) {
    if (!in.more_on_line()) continue;
    if (in.accept("format")) {
      header.encoding = parse_encoding(in);
      has_format = true;
    } else if (in.accept("element")) {
      header.elements.push_back(parse_element(in));
    } else if (in.accept("property")) {
      if (header.elements.empty()) in.fail("a property precedes the first element");
      header.elements.back().properties.push_back(parse_property(in));
    } else if (in.accept("end_header")) {
      if (!has_format) in.fail("the PLY header has no format");
      in.skip_line();
      header.size = bytes.size() - in.remaining();
      return header;
    } else if (!in.accept("comment") && !in.accept("obj_info")) {
      in.fail_at_word("expected element, property or end_header in the PLY header");
    }
  }
  in.fail("the PLY header has no end; the file is truncated");
}

}  // namespace sdm::io
