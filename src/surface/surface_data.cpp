#include "surface/surface_data.h"

#include <sdm/error.h>

#include <algorithm>
#include <string>
#include <utility>

#include "atlas/layout.h"
#include "atlas/packing/pack.h"
#include "atlas/texel_owners.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "mesh/validate.h"
#include "surface/sample_order.h"
#include "surface/stored_atlas.h"

namespace sdm::surface {
namespace {

std::uint32_t rows_of(const AtlasOptions& options) {
  return options.rows.value_or(options.resolution);
}

void check(const Mesh& mesh, const AtlasOptions& options) {
  validate(mesh);
  check_options(options);
  const std::uint32_t n = options.resolution, rows = rows_of(options);
  check_options(AtlasOptions{.resolution = rows});
  if (n != rows && options.kind != AtlasKind::uv)
    throw Error(
        "only atlases from texture coordinates may have more columns than rows or fewer; use a square",
        Remedy::resolution);
  if (options.gutter > std::min(n, rows) / 4)
    throw Error("a gutter of " + std::to_string(options.gutter) + " texels is too wide for an atlas of " +
                atlas::size_text(n, rows) + " texels; use a quarter of that at most");
  // The texel table, its order and its points, and the chart and layout data of each face.
  constexpr std::size_t kBytesPerTexel = 64, kBytesPerFace = 600;
  require_memory(kBytesPerTexel * n * rows + kBytesPerFace * mesh.triangles.size(), "the atlas");
}

}  // namespace

SurfaceData::SurfaceData(Mesh laid_out, const AtlasOptions& options)
    : kind(options.kind),
      resolution(options.resolution),
      rows(rows_of(options)),
      gutter(options.gutter),
      stretch_limit(options.max_stretch) {
  check(laid_out, options);
  atlas::Layout layout =
      kind == AtlasKind::uv ? atlas::uv_layout(laid_out, options) : atlas::chart_layout(laid_out, options);
  face_charts.assign(laid_out.triangles.size(), kNone);
  for (std::uint32_t c = 0; c < layout.charts.size(); ++c)
    for (const std::uint32_t f : layout.charts[c]) face_charts[f] = c;
  map_faces = atlas::rasterise(layout, kind, resolution, rows, overlapping_texels);
  if (std::ranges::all_of(map_faces, [](std::uint32_t face) { return face == kNone; }))
    throw atlas::TooSmall(
        "no face of the mesh is large enough in the texture to own a texel; use a larger resolution",
        std::uint64_t{2} * resolution);
  mesh = std::move(laid_out);
  chart_count = layout.charts.size();
  max_stretch = layout.max_stretch;
  scale = layout.scale;
  maps = std::move(layout.maps);
  corners = std::move(layout.corners);
  add_own_points();
  samples = sample_order(*this);
  sample_faces.resize(samples.size());
  parallel_for(samples.size(), 65536, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) sample_faces[i] = map_faces[samples[i]];
  });
}

SurfaceData::SurfaceData(Mesh laid_out, const AtlasOptions& options, std::span<const std::uint8_t> atlas)
    : mesh(std::move(laid_out)),
      kind(options.kind),
      resolution(options.resolution),
      rows(rows_of(options)),
      gutter(options.gutter),
      stretch_limit(options.max_stretch) {
  check(mesh, options);
  restore_atlas(*this, options, atlas);
}

void SurfaceData::refit(std::span<const Vec3> positions) {
  intact_.require();
  std::vector<Vec3>& current = mesh.positions;
  mesh::validate_positions(positions, current.size());
  const auto move = [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const Triangle& t = mesh.triangles[f];
      const bool moved = std::ranges::any_of(t, [&](std::uint32_t v) { return positions[v] != current[v]; });
      if (moved && face_charts[f] != kNone) maps[f].edges = atlas::moved_edges(corners[f], positions, t);
    }
  };
  intact_.change([&] {
    parallel_for(mesh.triangles.size(), 4096, move);
    std::ranges::copy(positions, current.begin());
    outward_normals.forget();
    drawn_normals.forget();
  });
}

void SurfaceData::add_own_points() {
  face_samples.assign(face_charts.size(), 0);
  for (const std::uint32_t face : map_faces)
    if (face != kNone) ++face_samples[face];
  for (std::uint32_t face = 0; face < face_charts.size(); ++face)
    if (face_charts[face] != kNone && face_samples[face] == 0) map_faces.push_back(face);
  for (std::size_t i = texels(); i < map_faces.size(); ++i) face_samples[map_faces[i]] = 1;
}

Vec2 SurfaceData::texel_weights(std::uint32_t face, std::uint32_t texel) const {
  if (texel >= texels()) return own_weights(face);
  const auto& [p, q, r] = corners[face];
  const Vec2 a = q - p, b = r - p, c = r - q;
  const Vec2 d = Vec2{texel % resolution + 0.5, texel / resolution + 0.5} - p;
  const double det = cross(a, b);
  if (!atlas::is_needle(corners[face])) return {cross(d, b) / det, cross(a, d) / det};
  // A chart without area owns a texel, too: the point on its longest side.
  const double aa = dot(a, a), bb = dot(b, b), cc = dot(c, c), longest = std::max({aa, bb, cc});
  if (longest == 0) return {};
  const auto along = [](double t) { return std::clamp(t, 0.0, 1.0); };
  if (longest == aa) return {along(dot(d, a) / aa), 0};
  if (longest == bb) return {0, along(dot(d, b) / bb)};
  const double t = along(dot(d - a, c) / cc);
  return {1 - t, t};
}

void SurfaceData::place_samples(std::size_t first, std::span<Vec3> points) const {
  const std::uint32_t end_of_texels = this->texels();
  const std::uint32_t* texels = samples.data() + first;
  const std::uint32_t* faces = sample_faces.data() + first;
  // The quotient of texel + 1/2 is at least 1/2 / resolution away from integers: its rounding does not
  // matter.
  const double inverse = 1.0 / resolution;
  constexpr std::size_t kAhead = 16;  // faces are scattered: prefetch what the samples after these will need
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i + 2 * kAhead < points.size()) {
      __builtin_prefetch(&mesh.triangles[faces[i + 2 * kAhead]]);
      const atlas::FaceMap& map = maps[faces[i + kAhead]];  // mostly in two cache lines
      __builtin_prefetch(&map.origin);
      __builtin_prefetch(&map.edges[1][2]);
      __builtin_prefetch(&mesh.positions[mesh.triangles[faces[i + kAhead]][0]]);
    }
    if (texels[i] >= end_of_texels) {
      points[i] = own_point(faces[i]);
      continue;
    }
    const auto row = static_cast<std::uint32_t>((texels[i] + 0.5) * inverse);
    const std::uint32_t column = texels[i] - row * resolution;
    points[i] = to_surface(faces[i], {column + 0.5, row + 0.5});
  }
}

std::vector<Vec3> SurfaceData::sample_points() const {
  std::vector<Vec3> points(samples.size());
  parallel_for(points.size(), 4096, [&](std::size_t begin, std::size_t end) {
    place_samples(begin, std::span(points).subspan(begin, end - begin));
  });
  return points;
}

}  // namespace sdm::surface
