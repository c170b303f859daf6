#include <fmt/format.h>

#include "io/read/formats.h"
#include "io/read/text_scanner.h"

namespace sdm::io {
namespace {

// The highest index in any face, and its position. Faces may precede the items that they refer to, so it is
// checked at the end.
struct HighestIndex {
  std::uint32_t index = 0;
  const char* at = nullptr;
};

// Reads an index: positive ones count from 1, negative ones backwards from the last of the `count` items so
// far. The result counts from 0.
std::uint32_t parse_index(TextScanner& in, std::size_t count, HighestIndex& highest) {
  const char* at = in.position();
  const std::int64_t i = in.integer();
  const std::int64_t index = i > 0 ? i - 1 : static_cast<std::int64_t>(count) + i;
  if (i == 0 || index < 0 || index >= kNone)
    in.fail_at(at, fmt::format("index out of range: a face refers to item {}", i));
  const auto result = static_cast<std::uint32_t>(index);
  if (!highest.at || result > highest.index) highest = {result, at};
  return result;
}

class ObjReader {
 public:
  explicit ObjReader(std::string_view text) : in_(text) {}

  PolygonMesh read() {
    for (; !in_.at_end(); in_.skip_line()) {
      if (!in_.more_on_line()) continue;
      if (in_.accept("v"))
        read_position();
      else if (in_.accept("vt"))
        read_uv();
      else if (in_.accept("f"))
        read_face();
      else if (in_.accept("usemtl"))
        read_name(mesh_.materials);
      else if (in_.accept("g"))
        read_name(mesh_.groups);
      else if (in_.accept("o"))
        read_name(mesh_.objects);
    }
    check(highest_vertex_, mesh_.positions.size(), "vertex");
    check(highest_uv_, mesh_.uvs.size(), "texture coordinate");
    return std::move(mesh_);
  }

 private:
  void read_position() {
    const double x = in_.number(), y = in_.number(), z = in_.number();
    mesh_.positions.push_back({x, y, z});
  }
  void read_uv() {
    const double u = in_.number();
    mesh_.uvs.push_back({u, in_.more_on_line() ? in_.number() : 0});
  }
  // Corners are v, v/vt, v//vn or v/vt/vn.
  void read_face() {
    while (in_.more_on_line()) {
      mesh_.corners.push_back(parse_index(in_, mesh_.positions.size(), highest_vertex_));
      std::uint32_t uv = kNone;
      if (in_.accept('/')) {
        if (in_.in_word() && !in_.accept('/')) {
          uv = parse_index(in_, mesh_.uvs.size(), highest_uv_);
          in_.accept('/');
        }
        if (in_.in_word()) in_.integer();
      }
      mesh_.corner_uvs.push_back(uv);
    }
    mesh_.end_polygon();
  }
  // The rest of the line: names may contain blanks, and a face may be in several groups.
  void read_name(PolygonNames& names) {
    std::string name;
    while (in_.more_on_line()) name.append(name.empty() ? "" : " ").append(in_.word());
    names.begin(mesh_.ends.size(), name);
  }
  void check(const HighestIndex& highest, std::size_t count, std::string_view item) const {
    if (highest.at && highest.index >= count)
      in_.fail_at(highest.at, fmt::format("index out of range: a face refers to {} {} of {}", item,
                                          std::size_t{highest.index} + 1, count));
  }

  TextScanner in_;
  PolygonMesh mesh_;
  HighestIndex highest_vertex_, highest_uv_;
};

}  // namespace

PolygonMesh read_obj(std::string_view text) {
  return ObjReader(text).read();
}

}  // namespace sdm::io
