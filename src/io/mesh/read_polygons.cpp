#include "io/mesh/read_polygons.h"

#include <fmt/format.h>
#include <sdm/error.h>
#include <sdm/mesh_files.h>

#include <algorithm>
#include <array>
#include <vector>

#include "io/file/encodings.h"
#include "io/file/text_scanner.h"
#include "io/mesh/formats.h"

namespace sdm::io {
namespace {

// Whether the first bytes are text: no control characters except whitespace.
bool is_text(std::string_view bytes) {
  return std::all_of(bytes.begin(), bytes.begin() + std::min<std::size_t>(bytes.size(), 1024),
                     [](char c) { return static_cast<unsigned char>(c) >= ' ' || (c >= '\t' && c <= '\r'); });
}

// What the formats are recognised by.
struct Content {
  std::string_view bytes;
  bool text;
  std::string_view first_word;  ///< empty unless text

  explicit Content(std::string_view all) : bytes(all), text(is_text(all)) {
    if (TextScanner in(all); text && in.next_word()) first_word = in.word();
  }
};

bool is_obj(const Content& content) {
  constexpr std::string_view statements[] = {"v", "vt", "vn", "vp", "f",      "l",
                                             "p", "o",  "g",  "s",  "mtllib", "usemtl"};
  return std::ranges::find(statements, content.first_word) != std::end(statements);
}

PolygonMesh read_stl(std::string_view bytes) {
  return is_stl_binary(bytes) || !is_text(bytes) ? read_stl_binary(bytes) : read_stl_text(bytes);
}

template <auto Read>
PolygonMesh read_by_module(std::string_view bytes, const std::filesystem::path& file,
                           const PolygonOptions& options) {
  return Read(bytes, file, options.tessellation);
}

struct Format {
  std::string_view names;                      ///< for messages
  std::array<std::string_view, 2> extensions;  ///< in lower case
  bool text_only;
  bool (*matches)(const Content& content);
  PolygonMesh (*read)(std::string_view bytes, const std::filesystem::path& file,
                      const PolygonOptions& options);
};

// The table of formats. The first that matches the content is taken, else the one with the extension.
constexpr Format kFormats[] = {
    {"glTF, GLB",
     {".gltf", ".glb"},
     false,
     [](const Content& c) { return c.bytes.starts_with("glTF") || c.first_word.starts_with('{'); },
     [](std::string_view bytes, const auto& file, const auto& options) {
       return read_gltf(bytes, file, options.attributes);
     }},
    {"STEP",
     {".step", ".stp"},
     true,
     [](const Content& c) { return is_step(c.bytes); },
     read_by_module<read_step>},
    {"IGES",
     {".iges", ".igs"},
     true,
     [](const Content& c) { return is_iges(c.bytes); },
     read_by_module<read_iges>},
    {"STL",
     {".stl"},
     false,
     [](const Content& c) { return is_stl_binary(c.bytes) || same_word(c.first_word, "solid"); },
     [](std::string_view bytes, const auto&, const auto&) { return read_stl(bytes); }},
    {"PLY",
     {".ply"},
     false,
     [](const Content& c) { return TextScanner(c.bytes).accept("ply"); },
     [](std::string_view bytes, const auto&, const auto& options) {
       return read_ply(bytes, options.attributes);
     }},
    {"OFF",
     {".off"},
     true,
     [](const Content& c) { return is_off_header(c.first_word); },
     [](std::string_view bytes, const auto&, const auto&) { return read_off(bytes); }},
    {"OBJ",
     {".obj"},
     true,
     is_obj,
     [](std::string_view bytes, const auto& file, const auto& options) {
       return read_obj(bytes, file, options.attributes);
     }},
    {"3DS",
     {".3ds"},
     false,
     [](const Content& c) { return !c.text && c.bytes.starts_with("MM"); },
     [](std::string_view bytes, const auto&, const auto&) { return read_3ds(bytes); }},
};

const Format* format_of_extension(std::string_view extension) {
  std::string lower(extension);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  const Format* format = std::ranges::find_if(kFormats, [&](const Format& f) {
    return std::ranges::count(f.extensions, std::string_view(lower)) > 0;
  });
  return lower.empty() || format == std::end(kFormats) ? nullptr : format;
}

const Format* find_format(const Content& content, const std::filesystem::path& file) {
  for (const Format& format : kFormats)
    if (format.matches(content)) return &format;
  refuse_encoded(content.bytes);
  return format_of_extension(file.extension().string());
}

std::string_view without_byte_order_mark(std::string_view bytes) {
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);  // the UTF-8 byte order mark
  return bytes;
}

}  // namespace

bool is_mesh_extension(std::string_view extension) {
  return format_of_extension(extension) != nullptr;
}

bool is_gltf(std::string_view bytes, const std::filesystem::path& file) {
  return find_format(Content(without_byte_order_mark(bytes)), file) == &kFormats[0];
}

std::string_view mesh_format_of(std::string_view begin) {
  const Content content(without_byte_order_mark(begin));
  const Format* format = std::ranges::find_if(kFormats, [&](const Format& f) { return f.matches(content); });
  return format == std::end(kFormats) ? std::string_view() : format->names;
}

PolygonMesh read_polygons(std::string_view bytes, const std::filesystem::path& file,
                          const PolygonOptions& options) {
  const Content content(without_byte_order_mark(bytes));
  const Format* format = find_format(content, file);
  if (format == nullptr) throw Error(fmt::format("unknown format; {} are supported", mesh_format_names()));
  if (format->text_only && !content.text)
    throw Error("holds binary data where text is expected; it is damaged or has another format");
  return format->read(content.bytes, file, options);
}

}  // namespace sdm::io

namespace sdm {

std::string mesh_format_names() {
  std::vector<std::string_view> names;
  for (const io::Format& format : io::kFormats)
    if (io::reads_cad() || (format.names != "STEP" && format.names != "IGES")) names.push_back(format.names);
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace sdm
