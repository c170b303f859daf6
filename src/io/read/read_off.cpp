#include <fmt/format.h>
#include <sdm/error.h>

#include "io/read/formats.h"
#include "io/read/text_scanner.h"

namespace sdm::io {
namespace {

// The prefixes of a header, in Geomview's order: [ST][C][N][4][n]OFF.
struct Header {
  bool is_off = false, uvs = false, colours = false, normals = false, four = false, any_dimension = false;
};

Header parse_header(std::string_view word) {
  Header header;
  const auto prefix = [&](std::string_view p) {
    if (!word.starts_with(p)) return false;
    word.remove_prefix(p.size());
    return true;
  };
  header.uvs = prefix("ST");
  header.colours = prefix("C");
  header.normals = prefix("N");
  header.four = prefix("4");
  header.any_dimension = prefix("n");
  header.is_off = word == "OFF";
  return header.is_off ? header : Header{};
}

std::size_t parse_count(TextScanner& in) {
  if (!in.next_word()) in.fail("the counts of vertices and faces are missing");
  const char* at = in.position();
  const std::int64_t count = in.integer();
  if (count < 0) in.fail_at(at, "a count is negative");
  return static_cast<std::size_t>(count);
}

// The last two numbers of a line.
Vec2 parse_last_two(TextScanner& in) {
  Vec2 last{};
  for (int count = 0; in.more_on_line() || count < 2; ++count) last = {last[1], in.number()};
  return last;
}

}  // namespace

bool is_off_header(std::string_view word) {
  return parse_header(word).is_off;
}

PolygonMesh read_off(std::string_view text) {
  TextScanner in(text);
  Header header;
  if (in.next_word()) {
    TextScanner ahead = in;
    header = parse_header(ahead.word());
    if (header.is_off) in = ahead;  // the header is optional
  }
  if (header.four || header.any_dimension) throw Error("OFF is supported in three dimensions only");
  if (header.is_off && in.more_on_line() && in.accept("BINARY"))
    throw Error("binary OFF is not supported; save it as text");

  const std::size_t vertices = parse_count(in), faces = parse_count(in);
  in.skip_line();  // the edge count, if any, is unreliable
  // A vertex takes at least the 6 bytes "0 0 0\n", a face the 2 bytes "0\n"; the last newline may be missing.
  if (vertices > in.remaining() || faces > in.remaining() || 6 * vertices + 2 * faces > in.remaining() + 1)
    throw Error(
        fmt::format("the header declares {} vertices and {} faces, more than the file can hold; it is "
                    "truncated or damaged",
                    vertices, faces));

  PolygonMesh mesh;
  mesh.positions.reserve(vertices);
  for (std::size_t v = 0; v < vertices; ++v, in.skip_line()) {
    const double x = in.number_across_lines(), y = in.number_across_lines(), z = in.number_across_lines();
    mesh.positions.push_back({x, y, z});
    for (int k = 0; header.normals && k < 3; ++k) in.number_across_lines();
    if (header.uvs) mesh.uvs.push_back(parse_last_two(in));
  }
  mesh.ends.reserve(faces);
  mesh.corners.reserve(3 * faces);
  for (std::size_t f = 0; f < faces; ++f, in.skip_line()) {
    if (!in.next_word()) in.fail(fmt::format("the text ends before face {}; the file is truncated", f));
    const std::int64_t corners = in.integer();
    for (std::int64_t k = 0; k < corners; ++k) {
      if (!in.next_word()) in.fail("the text ends within a face; the file is truncated");
      const char* at = in.position();
      const std::int64_t v = in.integer();
      if (v < 0 || static_cast<std::size_t>(v) >= vertices)
        in.fail_at(at, fmt::format("index out of range: a face refers to vertex {} of {}", v, vertices));
      mesh.corners.push_back(static_cast<std::uint32_t>(v));
    }
    mesh.end_polygon();
  }
  if (header.uvs) mesh.corner_uvs = mesh.corners;
  return mesh;
}

}  // namespace sdm::io
