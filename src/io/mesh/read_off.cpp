#include <fmt/format.h>
#include <sdm/error.h>

#include "io/file/text_scanner.h"
#include "io/mesh/formats.h"

namespace sdm::io {
namespace {

// The prefixes of a header, in Geomview's order: [ST][C][N][4][n]OFF.
struct Header {
  std::size_t length = 0;  ///< of the word, without a count that follows it without a blank; 0: not of OFF
  bool uvs = false, colours = false, normals = false, four = false, any_dimension = false;
};

Header parse_header(std::string_view word) {
  Header header;
  std::string_view rest = word;
  const auto prefix = [&](std::string_view p) {
    if (!rest.starts_with(p)) return false;
    rest.remove_prefix(p.size());
    return true;
  };
  header.uvs = prefix("ST");
  header.colours = prefix("C");
  header.normals = prefix("N");
  header.four = prefix("4");
  header.any_dimension = prefix("n");
  if (!prefix("OFF") || rest.find_first_not_of("0123456789") != std::string_view::npos) return {};
  header.length = word.size() - rest.size();
  return header;
}

std::size_t parse_count(TextScanner& in) {
  if (!in.next_word()) in.fail("the counts of vertices and faces are missing");
  const char* at = in.position();
  const std::int64_t count = in.integer();
  if (count < 0) in.fail_at(at, "a count is negative");
  return static_cast<std::size_t>(count);
}

class OffReader {
 public:
  explicit OffReader(std::string_view text) : rows_(TextScanner(text)) {}

  PolygonMesh read() {
    read_header();
    TextScanner& in = rows_.scanner();
    const std::size_t vertices = parse_count(in), faces = parse_count(in);
    if (in.more_on_line()) in.word();  // the edge count, if any, is unreliable
    if (in.more_on_line())
      in.fail("more than the counts of vertices, faces and edges; the first vertex begins on the next line");
    // A vertex takes at least the 6 bytes "0 0 0\n", a face the 2 bytes "0\n"; the last newline may be
    // missing.
    if (vertices > in.remaining() || faces > in.remaining() || 6 * vertices + 2 * faces > in.remaining() + 1)
      throw Error(
          fmt::format("the header declares {} vertices and {} faces, more than the file can hold; it is "
                      "truncated or damaged",
                      vertices, faces));
    mesh_.positions.reserve(vertices);
    for (std::size_t v = 0; v < vertices; ++v) read_vertex(v);
    mesh_.ends.reserve(faces);
    mesh_.corners.reserve(3 * faces);
    for (std::size_t f = 0; f < faces; ++f) read_face(f);
    if (in.next_word())
      mesh_.notes.push_back(fmt::format("what follows the {} declared faces, from line {} on, is left out",
                                        faces, in.line_of(in.position())));
    if (header_.uvs) mesh_.corner_uvs = mesh_.corners;
    return std::move(mesh_);
  }

 private:
  // The header is optional.
  void read_header() {
    TextScanner& in = rows_.scanner();
    if (!in.next_word()) return;
    TextScanner ahead = in;
    const std::string_view word = ahead.word();
    header_ = parse_header(word);
    for (std::size_t i = 0; i < header_.length; ++i) in.accept(word[i]);
    if (header_.length > 0 && in.more_on_line() && in.accept("BINARY"))
      throw Error("binary OFF is not supported; save it as text");
    if (header_.any_dimension)
      if (const std::size_t dimension = parse_count(in); dimension != 3)
        throw Error(
            fmt::format("nOFF of {} dimensions; OFF is supported in three dimensions only", dimension));
  }

  void read_vertex(std::size_t v) {
    rows_.begin();
    Vec3& p = mesh_.positions.emplace_back();
    for (double& x : p) x = rows_.number();
    if (header_.four) {  // homogeneous coordinates
      const double w = rows_.number();
      for (double& x : p) x /= w;
    }
    for (int k = 0; header_.normals && k < 3; ++k) rows_.number();
    const auto name = [&] { return fmt::format("vertex {}", v); };
    if (!header_.colours) {
      if (header_.uvs) {
        const double s = rows_.number();
        mesh_.uvs.push_back({s, rows_.number()});
      }
      rows_.end(name);
    } else if (!header_.uvs) {
      rows_.end(name, kMostColours);
    } else {
      // Colours, whose number is not fixed, precede the texture coordinates: those are the last two numbers.
      Vec2 last{};
      int count = 0;
      for (TextScanner& in = rows_.scanner(); (in.more_on_line() || count < 2) && count < kMostColours + 2;
           ++count)
        last = {last[1], in.number()};
      rows_.end(name);
      mesh_.uvs.push_back(last);
    }
  }

  void read_face(std::size_t f) {
    rows_.begin();
    TextScanner& in = rows_.scanner();
    if (in.at_end()) in.fail(fmt::format("the text ends before face {}; the file is truncated", f));
    const char* start = in.position();
    const std::int64_t corners = rows_.integer();
    if (corners < 0) in.fail_at(start, fmt::format("face {} has a negative number of corners", f));
    for (std::int64_t k = 0; k < corners; ++k) {
      if (!rows_.next()) in.fail("the text ends within a face; the file is truncated");
      const char* at = in.position();
      const std::int64_t v = in.integer();
      if (v < 0 || static_cast<std::size_t>(v) >= mesh_.positions.size())
        in.fail_at(at, fmt::format("index out of range: a face refers to vertex {} of {}", v,
                                   mesh_.positions.size()));
      mesh_.corners.push_back(static_cast<std::uint32_t>(v));
    }
    mesh_.end_polygon();
    rows_.end([&] { return fmt::format("face {}", f); }, kMostColours);
  }

  static constexpr int kMostColours = 4;  ///< numbers of the colour of a vertex or a face
  TextRows rows_;
  Header header_;
  PolygonMesh mesh_;
};

}  // namespace

bool is_off_header(std::string_view word) {
  return parse_header(word).length > 0;
}

PolygonMesh read_off(std::string_view text) {
  return OffReader(text).read();
}

}  // namespace sdm::io
