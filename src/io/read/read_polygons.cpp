#include "io/read/read_polygons.h"

#include <sdm/error.h>

#include <algorithm>

#include "io/read/formats.h"
#include "io/read/text_scanner.h"

namespace sdm::io {
namespace {

// Whether the first bytes are text: no control characters except whitespace.
bool is_text(std::string_view bytes) {
  return std::all_of(bytes.begin(), bytes.begin() + std::min<std::size_t>(bytes.size(), 1024),
                     [](char c) { return static_cast<unsigned char>(c) >= ' ' || (c >= '\t' && c <= '\r'); });
}

MeshFormat format_of_content(std::string_view bytes) {
  if (bytes.starts_with("glTF")) return MeshFormat::gltf;
  if (is_stl_binary(bytes)) return MeshFormat::stl_binary;
  TextScanner in(bytes);
  if (in.accept("ply")) return MeshFormat::ply;
  if (!is_text(bytes)) return bytes.starts_with("MM") ? MeshFormat::tds : MeshFormat::unknown;
  if (!in.next_word()) return MeshFormat::unknown;
  const std::string_view word = in.word();
  if (word.starts_with('{')) return MeshFormat::gltf;
  if (word == "solid" || word == "SOLID") return MeshFormat::stl_text;
  if (is_off_header(word)) return MeshFormat::off;
  constexpr std::string_view statements[] = {"v", "vt", "vn", "f", "o", "g", "s", "mtllib", "usemtl"};
  if (std::ranges::find(statements, word) != std::end(statements)) return MeshFormat::obj;
  return MeshFormat::unknown;
}

MeshFormat format_of_extension(const std::filesystem::path& file, bool text) {
  std::string extension = file.extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  if (extension == ".obj") return MeshFormat::obj;
  if (extension == ".ply") return MeshFormat::ply;
  if (extension == ".stl") return text ? MeshFormat::stl_text : MeshFormat::stl_binary;
  if (extension == ".off") return MeshFormat::off;
  if (extension == ".gltf" || extension == ".glb") return MeshFormat::gltf;
  if (extension == ".3ds") return MeshFormat::tds;
  return MeshFormat::unknown;
}

std::string_view without_byte_order_mark(std::string_view bytes) {
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);  // the UTF-8 byte order mark
  return bytes;
}

}  // namespace

MeshFormat format_of(std::string_view bytes, const std::filesystem::path& file) {
  bytes = without_byte_order_mark(bytes);
  const MeshFormat format = format_of_content(bytes);
  return format == MeshFormat::unknown ? format_of_extension(file, is_text(bytes)) : format;
}

PolygonMesh read_polygons(std::string_view bytes, const std::filesystem::path& file) {
  bytes = without_byte_order_mark(bytes);
  const MeshFormat format = format_of(bytes, file);
  if (!is_text(bytes) && (format == MeshFormat::obj || format == MeshFormat::off))
    throw Error("holds binary data where text is expected; it is damaged or has another format");
  switch (format) {
    case MeshFormat::obj:
      return read_obj(bytes);
    case MeshFormat::ply:
      return read_ply(bytes);
    case MeshFormat::stl_text:
      return read_stl_text(bytes);
    case MeshFormat::stl_binary:
      return read_stl_binary(bytes);
    case MeshFormat::off:
      return read_off(bytes);
    case MeshFormat::gltf:
      return read_gltf(bytes, file);
    case MeshFormat::tds:
      return read_3ds(bytes);
    case MeshFormat::unknown:
      break;
  }
  throw Error("unknown format; OBJ, PLY, STL, OFF, glTF, GLB and 3DS are supported");
}

}  // namespace sdm::io
