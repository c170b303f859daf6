#include <sdm/error.h>
#include <sdm/io.h>

#include <algorithm>
#include <new>

#include "io/read/byte_scanner.h"
#include "io/read/file_bytes.h"
#include "io/read/formats.h"
#include "io/read/text_scanner.h"

namespace sdm {
namespace {

enum class Format { unknown, obj, ply, stl_text, stl_binary, off, gltf, tds };

// Text as far as the first bytes tell: no control characters but blanks.
bool is_text(std::string_view bytes) {
  return std::all_of(bytes.begin(), bytes.begin() + std::min<std::size_t>(bytes.size(), 1024),
                     [](char c) { return static_cast<unsigned char>(c) >= ' ' || (c >= '\t' && c <= '\r'); });
}

Format format_of_content(std::string_view bytes) {
  if (bytes.starts_with("glTF")) return Format::gltf;
  if (is_stl_binary(bytes)) return Format::stl_binary;
  TextScanner in(bytes);
  if (in.accept("ply")) return Format::ply;
  if (!is_text(bytes)) return bytes.starts_with("MM") ? Format::tds : Format::unknown;
  if (!in.next_word()) return Format::unknown;
  const std::string_view word = in.word();
  if (word.starts_with('{')) return Format::gltf;
  if (word == "solid" || word == "SOLID") return Format::stl_text;
  if (is_off_header(word)) return Format::off;
  constexpr std::string_view statements[] = {"v", "vt", "vn", "f", "o", "g", "s", "mtllib", "usemtl"};
  if (std::ranges::find(statements, word) != std::end(statements)) return Format::obj;
  return Format::unknown;
}

Format format_of_extension(const std::filesystem::path& file, bool text) {
  std::string extension = file.extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  if (extension == ".obj") return Format::obj;
  if (extension == ".ply") return Format::ply;
  if (extension == ".stl") return text ? Format::stl_text : Format::stl_binary;
  if (extension == ".off") return Format::off;
  if (extension == ".gltf" || extension == ".glb") return Format::gltf;
  if (extension == ".3ds") return Format::tds;
  return Format::unknown;
}

PolygonMesh read_polygons(const std::filesystem::path& file) {
  const FileBytes contents = read_bytes(file);
  std::string_view bytes = contents.view();
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);  // the byte order mark of UTF-8
  const bool text = is_text(bytes);
  Format format = format_of_content(bytes);
  if (format == Format::unknown) format = format_of_extension(file, text);
  if (!text && (format == Format::obj || format == Format::off))
    throw Error("holds binary data where text is needed; it is damaged or of another format");
  switch (format) {
    case Format::obj:
      return read_obj(bytes);
    case Format::ply:
      return read_ply(bytes);
    case Format::stl_text:
      return read_stl_text(bytes);
    case Format::stl_binary:
      return read_stl_binary(bytes);
    case Format::off:
      return read_off(bytes);
    case Format::gltf:
      return read_gltf(bytes, file);
    case Format::tds:
      return read_3ds(bytes);
    case Format::unknown:
      break;
  }
  throw Error("the format is not known; OBJ, PLY, STL, OFF, glTF, GLB and 3DS are read");
}

}  // namespace

Mesh read_mesh(const std::filesystem::path& file) {
  try {
    Mesh mesh = to_mesh(read_polygons(file));
    validate(mesh);
    return mesh;
  } catch (const Error& fault) {
    throw Error(file.string() + ": " + fault.what());
  } catch (const std::bad_alloc&) {
    throw Error(file.string() + ": there is not enough memory to read it");
  }
}

}  // namespace sdm
