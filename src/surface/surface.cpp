#include <sdm/surface.h>

#include <new>
#include <utility>

#include "core/cancellation.h"
#include "core/memory.h"
#include "surface/stored_atlas.h"
#include "surface/surface_data.h"

namespace sdm {

Surface::Surface(Mesh mesh, const AtlasOptions& options) try
    : data_(std::make_unique<surface::SurfaceData>(std::move(mesh), options)) {
} catch (const std::bad_alloc&) {
  throw out_of_memory("the atlas");
}

Surface::Surface(Mesh mesh, const AtlasOptions& options, std::span<const std::uint8_t> stored_atlas) try
    : data_(std::make_unique<surface::SurfaceData>(std::move(mesh), options, stored_atlas)) {
} catch (const std::bad_alloc&) {
  throw out_of_memory("the atlas");
}

std::vector<std::uint8_t> Surface::stored_atlas() const try {
  return surface::store_atlas(internals(*this));
} catch (const std::bad_alloc&) {
  throw out_of_memory("storing the atlas");
}

void Surface::refit(std::span<const Vec3> positions) try {
  const Uncancellable whole;
  data_->refit(positions);
} catch (const std::bad_alloc&) {
  throw out_of_memory("the atlas");
}

void Surface::edit(const MeshEdit& edit) try {
  const Uncancellable whole;
  data_->edit(edit);
} catch (const std::bad_alloc&) {
  throw out_of_memory("the atlas");
}

Surface::~Surface() = default;
Surface::Surface(Surface&&) noexcept = default;
Surface& Surface::operator=(Surface&&) noexcept = default;

const Mesh& Surface::mesh() const {
  return internals(*this).mesh;
}
AtlasKind Surface::atlas_kind() const {
  return internals(*this).kind;
}
std::uint32_t Surface::resolution() const {
  return internals(*this).resolution;
}
std::uint32_t Surface::rows() const {
  return internals(*this).rows;
}
std::span<const std::uint32_t> Surface::texel_faces() const {
  return std::span(internals(*this).map_faces).first(internals(*this).texels());
}
std::span<const std::uint32_t> Surface::map_faces() const {
  return internals(*this).map_faces;
}
std::span<const std::uint32_t> Surface::sample_texels() const {
  return internals(*this).samples;
}
std::vector<Vec3> Surface::sample_points() const try {
  return internals(*this).sample_points();
} catch (const std::bad_alloc&) {
  throw out_of_memory("the samples of the atlas");
}
std::size_t Surface::chart_count() const {
  return internals(*this).chart_count;
}
std::span<const std::uint32_t> Surface::face_charts() const {
  return internals(*this).face_charts;
}
std::uint32_t Surface::gutter() const {
  return internals(*this).gutter;
}
std::size_t Surface::overlapping_texels() const {
  return internals(*this).overlapping_texels;
}

std::size_t Surface::faces_without_uv_area() const {
  const surface::SurfaceData& data = internals(*this);
  if (data.kind != AtlasKind::uv) return 0;
  std::size_t count = 0;
  for (std::size_t f = 0; f < data.face_charts.size(); ++f)
    if (data.face_charts[f] != kNone &&
        atlas::is_sliver(data.corners[f], data.mesh.corner_uvs[f], data.resolution, data.rows))
      ++count;
  return count;
}

double Surface::max_stretch() const {
  return internals(*this).max_stretch;
}

Vec3 Surface::texel_point(std::uint32_t texel) const {
  const surface::SurfaceData& data = internals(*this);
  return data.texel_point(data.map_faces[texel], texel);
}

Vec3 Surface::to_surface(std::uint32_t face, const Vec2& uv) const {
  return internals(*this).to_surface(face, uv);
}

// Solves p − vertex 0 = a ∂p/∂u + b ∂p/∂v in the plane of the two, with normal n = ∂p/∂u × ∂p/∂v: a |n|² = (p
// × ∂p/∂v)·n, b |n|² = (∂p/∂u × p)·n.
Vec2 Surface::to_atlas(std::uint32_t face, const Vec3& point) const {
  const surface::SurfaceData& data = internals(*this);
  const auto& [origin, edges] = data.maps[face];
  const Vec3 p = point - data.mesh.positions[data.mesh.triangles[face][0]];
  const Vec3 n = cross(edges[0], edges[1]);
  const double area = squared_norm(n);
  return origin + Vec2{dot(cross(p, edges[1]), n) / area, dot(cross(edges[0], p), n) / area};
}

std::array<Vec2, 3> Surface::atlas_corners(std::uint32_t face) const {
  return internals(*this).corners[face];
}

std::array<Vec3, 2> Surface::texel_edges(std::uint32_t face) const {
  return internals(*this).maps[face].edges;
}

std::size_t Surface::owned_texels() const {
  return internals(*this).owned_texels();
}

double Surface::utilisation() const {
  return static_cast<double>(owned_texels()) / internals(*this).texels();
}

}  // namespace sdm
