#include <fmt/format.h>
#include <sdm/error.h>

#include "io/read/byte_scanner.h"
#include "io/read/formats.h"
#include "io/read/text_scanner.h"

namespace sdm::io {
namespace {

// Binary: an 80-byte comment and a count; then, for each triangle, a normal, three corners and an attribute.
constexpr std::size_t kHeaderBytes = 84, kTriangleBytes = 50, kNormalBytes = 12;

std::uint32_t triangle_count(std::string_view bytes) {
  return load<std::uint32_t>(bytes.data() + 80);
}

// Some programs write keywords in upper case.
bool same_keyword(std::string_view word, std::string_view lower_case) {
  return std::equal(word.begin(), word.end(), lower_case.begin(), lower_case.end(),
                    [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
}

}  // namespace

bool is_stl_binary(std::string_view bytes) {
  return bytes.size() >= kHeaderBytes &&
         bytes.size() == kHeaderBytes + kTriangleBytes * triangle_count(bytes);
}

PolygonMesh read_stl_binary(std::string_view bytes) {
  if (bytes.size() < kHeaderBytes)
    throw Error(
        fmt::format("has {} bytes, fewer than the header of a binary STL; it is truncated", bytes.size()));
  const std::size_t count = triangle_count(bytes);
  if (bytes.size() < kHeaderBytes + kTriangleBytes * count)
    throw Error(
        fmt::format("the header declares {} triangles, more than the file of {} bytes can hold; it is "
                    "truncated or not STL",
                    count, bytes.size()));

  PolygonMesh mesh;
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
  TextScanner in(text);
  PolygonMesh mesh;
  bool in_solid = false, in_loop = false;
  for (; !in.at_end(); in.skip_line()) {
    if (!in.more_on_line()) continue;
    const std::string_view word = in.word();
    if (same_keyword(word, "vertex")) {
      if (!in_loop) in.fail("a vertex outside a loop");
      const double x = in.number(), y = in.number(), z = in.number();
      mesh.corners.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
      mesh.positions.push_back({x, y, z});
    } else if (same_keyword(word, "outer")) {
      in_loop = true;
    } else if (same_keyword(word, "endloop")) {
      in_loop = false;
      mesh.end_polygon();
    } else if (same_keyword(word, "solid")) {
      in_solid = true;
      std::string name;
      while (in.more_on_line()) name.append(name.empty() ? "" : " ").append(in.word());
      mesh.objects.begin(mesh.ends.size(), name);
    } else if (same_keyword(word, "endsolid")) {
      in_solid = false;
    }
  }
  if (in_solid || in_loop) in.fail("the text ends within a solid; the file is truncated");
  return mesh;
}

}  // namespace sdm::io
