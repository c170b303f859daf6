#include "surface/stored_atlas.h"

#include <sdm/error.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>

#include "atlas/layout.h"
#include "atlas/packing/fit.h"
#include "core/checksum.h"
#include "geometry/vec.h"
#include "surface/surface_data.h"

namespace sdm::surface {
namespace {

static_assert(std::endian::native == std::endian::little, "the order of the stored bytes");

struct Header {
  std::array<char, 8> magic{'s', 'd', 'm', 'a', 't', 'l', 'a', 's'};
  std::uint32_t version = 5, kind = 0, resolution = 0, gutter = 0;
  double stretch_limit = 0, max_stretch = 0, scale = 0;
  std::uint64_t vertices = 0, faces = 0, charts = 0, samples = 0, rows = 0, overlapping = 0;
  std::uint64_t first_rows = 0;          ///< before edits added any
  std::uint64_t mesh = 0, contents = 0;  ///< checksums: of the mesh, and of all else
};
static_assert(sizeof(Header) == 120, "no padding");

std::uint64_t checksum(Header header, std::span<const std::uint8_t> arrays) {
  header.contents = 0;
  core::Checksum sum;
  sum.add(std::span<const Header>(&header, 1));
  sum.add(arrays);
  return sum.value();
}

std::uint64_t checksum(const Mesh& mesh) {
  core::Checksum sum;
  sum.add(mesh.positions);
  sum.add(mesh.triangles);
  sum.add(mesh.corner_uvs);
  return sum.value();
}

Header header_of(const SurfaceData& s) {
  Header header;
  header.kind = static_cast<std::uint32_t>(s.kind);
  header.resolution = s.resolution;
  header.gutter = s.gutter;
  header.first_rows = s.first_rows;
  header.stretch_limit = s.stretch_limit;
  header.vertices = s.mesh.positions.size();
  header.faces = s.mesh.triangles.size();
  header.mesh = checksum(s.mesh);
  return header;
}

// Calls take(array, its length) for the arrays in the order of the file.
template <class Surface, class Take>
void for_each_array(Surface& s, const Header& header, const Take& take) {
  take(s.maps, header.faces);
  take(s.corners, header.faces);
  take(s.face_charts, header.faces);
  take(s.samples, header.samples);
  take(s.sample_faces, header.samples);
}

// Points of the surface are among its vertices, which are not larger; double precision has room for both.
constexpr double kLargest = 1e38;
bool within(const Vec3& p, double limit) {
  return std::abs(p[0]) <= limit && std::abs(p[1]) <= limit && std::abs(p[2]) <= limit;
}

bool valid(const SurfaceData& s, std::uint64_t charts) {
  const std::uint64_t texels = std::uint64_t{s.resolution} * s.rows;
  for (std::size_t f = 0; f < s.face_charts.size(); ++f) {
    if (s.face_charts[f] != kNone && s.face_charts[f] >= charts) return false;
    for (const auto& [x, y] : s.corners[f])
      if (!(x >= -1 && x <= s.resolution + 1.0 && y >= -1 && y <= s.rows + 1.0)) return false;
    if (!finite(s.maps[f].edges[0]) || !finite(s.maps[f].edges[1])) return false;
  }
  for (std::size_t i = 0; i < s.samples.size(); ++i)
    if (s.samples[i] >= texels + s.face_charts.size() || s.sample_faces[i] >= s.face_charts.size() ||
        s.face_charts[s.sample_faces[i]] == kNone ||
        !within(s.texel_point(s.sample_faces[i], s.samples[i]), kLargest))
      return false;
  return !s.samples.empty();
}

// Whether the samples of faces without a texel are those that the texels of the others leave.
bool has_own_points(const SurfaceData& s) {
  std::vector<std::uint8_t> found(s.faces_without_texel());
  for (std::size_t i = 0; i < s.samples.size(); ++i) {
    if (s.samples[i] < s.texels()) continue;
    const std::size_t place = s.samples[i] - s.texels();
    if (place >= found.size() || found[place] != 0 || s.map_faces[s.samples[i]] != s.sample_faces[i])
      return false;
    found[place] = 1;
  }
  return std::ranges::count(found, 0) == 0;
}

Header read_header(std::span<const std::uint8_t> bytes) {
  const Header expected;
  if (bytes.size() < sizeof(Header) || std::memcmp(bytes.data(), &expected, sizeof expected.magic) != 0)
    throw Error("it is not a stored atlas");
  Header header;
  std::memcpy(&header, bytes.data(), sizeof(Header));
  if (header.version != expected.version) throw Error("another version of sdm has stored the atlas");
  return header;
}

}  // namespace

AtlasOptions stored_options(std::span<const std::uint8_t> bytes) {
  const Header header = read_header(bytes);
  if (header.kind > static_cast<std::uint32_t>(AtlasKind::uv) || header.first_rows > atlas::kMaxRows)
    throw Error("the stored atlas is damaged");
  return {.kind = static_cast<AtlasKind>(header.kind),
          .resolution = header.resolution,
          .rows = static_cast<std::uint32_t>(header.first_rows),
          .max_stretch = header.stretch_limit,
          .gutter = header.gutter};
}

std::vector<std::uint8_t> store_atlas(const SurfaceData& s) {
  Header header = header_of(s);
  header.max_stretch = s.max_stretch;
  header.scale = s.scale;
  header.rows = s.rows;
  header.charts = s.chart_count;
  header.overlapping = s.overlapping_texels;
  header.samples = s.samples.size();
  std::size_t size = sizeof(Header);
  for_each_array(s, header,
                 [&](const auto& array, std::uint64_t) { size += array.size() * sizeof(array[0]); });
  std::vector<std::uint8_t> bytes(size);
  std::uint8_t* to = bytes.data() + sizeof(Header);
  for_each_array(s, header, [&](const auto& array, std::uint64_t) {
    std::memcpy(to, array.data(), array.size() * sizeof(array[0]));
    to += array.size() * sizeof(array[0]);
  });
  header.contents = checksum(header, std::span(bytes).subspan(sizeof(Header)));
  std::memcpy(bytes.data(), &header, sizeof(Header));
  return bytes;
}

void restore_atlas(SurfaceData& s, const AtlasOptions& options, std::span<const std::uint8_t> bytes) {
  const Header header = read_header(bytes), expected = header_of(s);
  bytes = bytes.subspan(sizeof(Header));
  if (header.vertices != expected.vertices || header.faces != expected.faces || header.mesh != expected.mesh)
    throw Error("the stored atlas belongs to another mesh");
  if (header.kind != expected.kind || header.resolution != expected.resolution ||
      header.first_rows != expected.first_rows || header.gutter != options.gutter ||
      header.stretch_limit != options.max_stretch)
    throw Error("the stored atlas has other options: a resolution of " +
                (header.first_rows == header.resolution
                     ? std::to_string(header.resolution)
                     : atlas::size_text(header.resolution, header.first_rows)) +
                ", a gutter of " + std::to_string(header.gutter) + ", a stretch of at most " +
                std::to_string(header.stretch_limit));

  const bool has_size = header.rows >= s.first_rows &&
                        header.rows <= std::max(s.first_rows, atlas::kMaxRows) && header.scale > 0 &&
                        std::isfinite(header.scale);
  const std::uint64_t texels = s.resolution * (has_size ? header.rows : 0);
  const std::uint64_t of_faces =
      header.faces * (sizeof s.maps[0] + sizeof s.corners[0] + sizeof(std::uint32_t));
  if (header.samples > texels + header.faces ||
      bytes.size() != of_faces + header.samples * 2 * sizeof(std::uint32_t) ||
      checksum(header, bytes) != header.contents)
    throw Error("the stored atlas is damaged");
  for_each_array(s, header, [&](auto& array, std::uint64_t count) {
    array.resize(count);
    std::memcpy(array.data(), bytes.data(), count * sizeof(array[0]));
    bytes = bytes.subspan(count * sizeof(array[0]));
  });
  if (options.strict_uv && header.overlapping > 0)
    throw Error("the stored atlas has faces that overlap in the texture");
  s.rows = static_cast<std::uint32_t>(header.rows);
  s.scale = header.scale;
  s.map_faces.assign(texels, kNone);
  if (!valid(s, header.charts)) throw Error("the stored atlas is damaged");
  for (std::size_t i = 0; i < s.samples.size(); ++i) {
    if (s.samples[i] >= texels) continue;
    std::uint32_t& owner = s.map_faces[s.samples[i]];
    if (owner != kNone) throw Error("the stored atlas is damaged");
    owner = s.sample_faces[i];
  }
  s.add_own_points();
  if (!has_own_points(s)) throw Error("the stored atlas is damaged");
  s.chart_count = header.charts;
  s.overlapping_texels = header.overlapping;
  s.max_stretch = header.max_stretch;
}

}  // namespace sdm::surface
