#include <fmt/format.h>
#include <sdm/error.h>

#include "io/file/byte_scanner.h"
#include "io/file/text_scanner.h"
#include "io/mesh/formats.h"

namespace sdm::io {
namespace {

// Binary: an 80-byte comment and a count; then, for each triangle, a normal, three corners and an attribute.
constexpr std::size_t kHeaderBytes = 84, kTriangleBytes = 50, kNormalBytes = 12;

std::uint32_t declared_count(std::string_view bytes) {
  return load<std::uint32_t>(bytes.data() + 80);
}

// The number of triangles to read. Programs that write to a stream leave 0 or 2^32 − 1 where they do not know
// the count, and others count wrong: more triangles than declared are read, if the file ends with a whole
// one. Fewer than declared mean a file that was cut.
std::size_t triangle_count(std::string_view bytes, std::vector<std::string>& notes) {
  const std::size_t declared = declared_count(bytes), data = bytes.size() - kHeaderBytes;
  const std::size_t present = data / kTriangleBytes;
  if (present == declared && data % kTriangleBytes == 0) return declared;
  const bool unknown = declared == 0 || declared == 0xFFFFFFFF;
  if (data % kTriangleBytes == 0 && present > 0 && (declared < present || unknown)) {
    notes.push_back(fmt::format("the header declares {} triangles, but the file has {}, which are read",
                                declared, present));
    return present;
  }
  if (declared > present || (unknown && present > 0))
    throw Error(
        fmt::format("the header declares {} triangles, {} than the file of {} bytes can hold; it is "
                    "truncated or not STL",
                    declared, declared > present ? "more" : "fewer", bytes.size()));
  notes.push_back(fmt::format("{} bytes after the {} declared triangles are ignored",
                              data - declared * kTriangleBytes, declared));
  return declared;
}

// Text is a sequence of words; only a name ends with its line.
class StlTextReader {
 public:
  explicit StlTextReader(std::string_view text) : in_(text) {}

  PolygonMesh read() {
    while (in_.next_word()) read_statement();
    if (in_loop_ || in_facet_ || (in_solid_ && mesh_.ends.empty()))
      in_.fail(fmt::format("the text ends within a {}; the file is truncated",
                           in_loop_ || in_facet_ ? "facet" : "solid"));
    if (in_solid_) mesh_.notes.emplace_back("the text ends without endsolid; the file may be truncated");
    return std::move(mesh_);
  }

 private:
  void read_statement() {
    const TextScanner start = in_;
    std::string_view word = in_.word();
    const bool end = same_word(word, "end");
    if (end && in_.next_word()) word = in_.word();
    const auto is = [&](std::string_view name) { return !end && same_word(word, name); };
    const auto ends = [&](std::string_view name) {
      return end ? same_word(word, name)
                 : word.size() > 3 && same_word(word.substr(0, 3), "end") && same_word(word.substr(3), name);
    };
    if (is("vertex")) {
      require(in_loop_, start, "a vertex outside a loop");
      const double x = in_.number_across_lines(), y = in_.number_across_lines(),
                   z = in_.number_across_lines();
      mesh_.corners.push_back(static_cast<std::uint32_t>(mesh_.positions.size()));
      mesh_.positions.push_back({x, y, z});
    } else if (is("facet")) {
      require(!in_loop_, start, "a facet begins within a loop");
      require(!in_facet_, start, "the facet before this one has no loop of vertices");
      in_facet_ = true;
      skip_normal();
    } else if (is("outer")) {
      require(!in_loop_, start, "a loop begins within a loop");
      in_loop_ = true;
      if (next_is("loop")) in_.word();
    } else if (ends("loop")) {
      require(in_loop_, start, "endloop outside a loop");
      in_loop_ = in_facet_ = false;
      end_facet(start);
    } else if (ends("facet")) {
      require(!in_loop_, start, "a facet ends within a loop");
      require(!in_facet_, start, "a facet has no loop of vertices");
    } else if (is("solid")) {
      require(!in_facet_, start, "a solid begins within a facet");
      in_solid_ = true;
      name_ = read_name();
      mesh_.objects.begin(mesh_.ends.size(), name_);
    } else if (ends("solid")) {
      require(!in_facet_, start, "a solid ends within a facet");
      in_solid_ = false;
      skip_name();
    } else {
      in_ = start;
      if (in_loop_) in_.fail_at_word("expected vertex or endloop");
      if (in_facet_) in_.fail_at_word("expected outer loop or endfacet");
      read_name();  // a statement between facets that some program has added
    }
  }

  static void require(bool holds, const TextScanner& at, std::string_view fault) {
    if (!holds) at.fail(fault);
  }

  void end_facet(const TextScanner& at) {
    const std::size_t begin = mesh_.ends.empty() ? 0 : mesh_.ends.back();
    const std::size_t corners = mesh_.corners.size() - begin;
    require(corners >= 3, at, fmt::format("a facet has {} vertices, fewer than three", corners));
    mesh_.end_polygon();
  }

  [[nodiscard]] bool next_is(std::string_view lower_case) const {
    TextScanner ahead = in_;
    return ahead.next_word() && same_word(ahead.word(), lower_case);
  }

  // Normals are not used: their numbers may be missing or of any form, such as -nan(ind).
  void skip_normal() {
    if (!next_is("normal")) return;
    in_.next_word();
    in_.word();
    for (int k = 0; k < 3 && in_.next_word() && !next_is("outer"); ++k) in_.word();
  }

  // Whether the next words of the line begin a facet, rather than belong to a name with the word facet.
  [[nodiscard]] bool at_facet() const {
    TextScanner ahead = in_;
    if (!same_word(ahead.word(), "facet") || !ahead.more_on_line()) return false;
    const std::string_view word = ahead.word();
    if (same_word(word, "outer")) return true;
    if (!same_word(word, "normal") || !ahead.more_on_line()) return false;
    const std::string_view number = ahead.word();
    return std::string_view("+-.0123456789").find(number[0]) != std::string_view::npos ||
           same_word(number.substr(0, 3), "nan") || same_word(number.substr(0, 3), "inf");
  }

  // The words up to the end of the line, or to a facet on it.
  std::string read_name() {
    std::string name;
    while (in_.more_on_line() && !at_facet()) name.append(name.empty() ? "" : " ").append(in_.word());
    return name;
  }

  // The name after endsolid, up to the end of the line or to what follows it: the name of the solid may
  // itself contain the word solid.
  void skip_name() {
    for (std::string_view rest = name_; !rest.empty() && in_.more_on_line();) {
      TextScanner ahead = in_;
      const std::string_view word = ahead.word();
      if (!rest.starts_with(word)) break;
      in_ = ahead;
      rest.remove_prefix(std::min(word.size() + 1, rest.size()));
    }
    while (in_.more_on_line() && !at_facet() && !next_is("solid")) in_.word();
  }

  TextScanner in_;
  PolygonMesh mesh_;
  std::string name_;  // of the last solid
  bool in_solid_ = false;
  bool in_facet_ = false, in_loop_ = false;  // before the end of its loop
};

}  // namespace

bool is_stl_binary(std::string_view bytes) {
  return bytes.size() >= kHeaderBytes &&
         bytes.size() == kHeaderBytes + kTriangleBytes * declared_count(bytes);
}

PolygonMesh read_stl_binary(std::string_view bytes) {
  if (bytes.size() < kHeaderBytes)
    throw Error(
        fmt::format("has {} bytes, fewer than the header of a binary STL; it is truncated", bytes.size()));
  PolygonMesh mesh;
  const std::size_t count = triangle_count(bytes, mesh.notes);
  mesh.positions.reserve(3 * count);
  mesh.corners.reserve(3 * count);
  mesh.ends.reserve(count);
  for (std::size_t f = 0; f < count; ++f) {
    const char* at = bytes.data() + kHeaderBytes + f * kTriangleBytes + kNormalBytes;
    for (int k = 0; k < 3; ++k, at += 12) {
      mesh.corners.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
      mesh.positions.push_back({load<float>(at), load<float>(at + 4), load<float>(at + 8)});
    }
    mesh.end_polygon();
  }
  return mesh;
}

PolygonMesh read_stl_text(std::string_view text) {
  return StlTextReader(text).read();
}

}  // namespace sdm::io
