#include <sdm/error.h>

#include <algorithm>
#include <string>
#include <utility>

#include "surface/surface_data.h"
#include "atlas/texel_owners.h"
#include "atlas/packing/too_small.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "core/spatial_order.h"
#include "core/vec.h"
#include "mesh/validate.h"

namespace sdm {
namespace {

constexpr std::uint32_t kMinResolution = 16, kMaxResolution = 32768;

void check(const Mesh& mesh, const AtlasOptions& options) {
  validate(mesh);
  const std::uint32_t n = options.resolution;
  if (n < kMinResolution || n > kMaxResolution)
    throw Error("an atlas resolution of " + std::to_string(n) + " is out of range; use 16 to 32768");
  if (!(options.max_stretch > 1))
    throw Error("a largest stretch of " + std::to_string(options.max_stretch) +
                " is out of range; use more than 1");
  if (options.gutter > n / 4)
    throw Error("a gutter of " + std::to_string(options.gutter) + " texels is too wide for an atlas of " +
                std::to_string(n) + "² texels; use a quarter of that at most");
  // The texel table, its order and its points; and what charts and layout keep of each face.
  constexpr std::size_t kBytesPerTexel = 64, kBytesPerFace = 600;
  require_memory(kBytesPerTexel * n * n + kBytesPerFace * mesh.triangles.size(), "the atlas");
}

Vec3 point_at(const SurfaceData& surface, std::uint32_t face, const Vec2& uv) {
  const FaceMap& map = surface.maps[face];
  const Vec2 d = uv - map.origin;
  return surface.mesh.positions[surface.mesh.triangles[face][0]] + d[0] * map.edges[0] + d[1] * map.edges[1];
}

Vec3 point_of(const SurfaceData& surface, std::uint32_t face, std::uint32_t texel) {
  const Vec2 centre = {texel % surface.resolution + 0.5, texel / surface.resolution + 0.5};
  return point_at(surface, face, centre);
}

void find_sample_faces(SurfaceData& surface) {
  surface.sample_faces.resize(surface.samples.size());
  std::ranges::transform(surface.samples, surface.sample_faces.begin(),
                         [&](std::uint32_t texel) { return surface.texel_faces[texel]; });
}

// Sets `points` to those of all samples.
void place_all(const SurfaceData& surface, std::vector<Vec3>& points) {
  points.resize(surface.samples.size());
  parallel_for(points.size(), 4096, [&](std::size_t begin, std::size_t end) {
    place_samples(surface, begin, std::span(points).subspan(begin, end - begin));
  });
}

// Puts the samples into an order in space.
void order_samples(SurfaceData& surface) {
  find_sample_faces(surface);
  std::vector<Vec3> points;
  place_all(surface, points);
  std::vector<std::uint32_t> order = spatial_order(points);
  for (std::uint32_t& index : order) index = surface.samples[index];
  surface.samples = std::move(order);
  find_sample_faces(surface);
}

}  // namespace

void place_samples(const SurfaceData& surface, std::size_t first, std::span<Vec3> points) {
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] = point_of(surface, surface.sample_faces[first + i], surface.samples[first + i]);
}

Surface::Surface(Mesh mesh, const AtlasOptions& options) {
  check(mesh, options);
  Layout layout = options.kind == AtlasKind::uv ? uv_layout(mesh, options) : chart_layout(mesh, options);
  std::vector<std::uint32_t> face_charts(mesh.triangles.size(), kNone);
  for (std::uint32_t c = 0; c < layout.charts.size(); ++c)
    for (const std::uint32_t f : layout.charts[c]) face_charts[f] = c;
  std::vector<std::uint32_t> texel_faces = rasterise(layout, options.kind, options.resolution);
  std::vector<std::uint32_t> samples = owned_texels(texel_faces);
  if (samples.empty())
    throw TooSmall(
        "no face of the mesh is large enough in the texture to own a texel; use a larger resolution",
        2 * options.resolution);
  impl_ = std::make_unique<Impl>();
  impl_->mesh = std::move(mesh);
  impl_->kind = options.kind;
  impl_->resolution = options.resolution;
  impl_->chart_count = layout.charts.size();
  impl_->max_stretch = layout.max_stretch;
  impl_->maps = std::move(layout.maps);
  impl_->corners = std::move(layout.corners);
  impl_->face_charts = std::move(face_charts);
  impl_->texel_faces = std::move(texel_faces);
  impl_->samples = std::move(samples);
  order_samples(*impl_);
}

void Surface::refit(std::span<const Vec3> positions) {
  Impl& s = *impl_;
  std::vector<Vec3>& current = s.mesh.positions;
  validate_positions(positions, current.size());
  parallel_for(s.mesh.triangles.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const Triangle& t = s.mesh.triangles[f];
      const bool moved = std::ranges::any_of(t, [&](std::uint32_t v) { return positions[v] != current[v]; });
      if (moved && s.face_charts[f] != kNone) s.maps[f].edges = affine_edges(s.corners[f], positions, t);
    }
  });
  std::ranges::copy(positions, current.begin());
  s.lazy.present.emplace();
}

Surface::~Surface() = default;
Surface::Surface(Surface&&) noexcept = default;
Surface& Surface::operator=(Surface&&) noexcept = default;

const Mesh& Surface::mesh() const {
  return impl_->mesh;
}
AtlasKind Surface::atlas_kind() const {
  return impl_->kind;
}
std::uint32_t Surface::resolution() const {
  return impl_->resolution;
}
std::span<const std::uint32_t> Surface::texel_faces() const {
  return impl_->texel_faces;
}
std::span<const std::uint32_t> Surface::samples() const {
  return impl_->samples;
}
std::span<const Vec3> Surface::sample_points() const {
  Impl::Lazy& lazy = impl_->lazy;
  std::call_once(lazy.present->placed, [&] { place_all(*impl_, lazy.sample_points); });
  return lazy.sample_points;
}
std::size_t Surface::chart_count() const {
  return impl_->chart_count;
}
std::span<const std::uint32_t> Surface::face_charts() const {
  return impl_->face_charts;
}
double Surface::max_stretch() const {
  return impl_->max_stretch;
}

Vec3 Surface::texel_point(std::uint32_t texel) const {
  return point_of(*impl_, impl_->texel_faces[texel], texel);
}

Vec3 Surface::to_surface(std::uint32_t face, const Vec2& uv) const {
  return point_at(*impl_, face, uv);
}

// Solves p − vertex 0 = a ∂p/∂u + b ∂p/∂v in the plane of the two, with normal n = ∂p/∂u × ∂p/∂v: a |n|² = (p
// × ∂p/∂v)·n, b |n|² = (∂p/∂u × p)·n.
Vec2 Surface::to_atlas(std::uint32_t face, const Vec3& point) const {
  const auto& [origin, edges] = impl_->maps[face];
  const Vec3 p = point - impl_->mesh.positions[impl_->mesh.triangles[face][0]];
  const Vec3 n = cross(edges[0], edges[1]);
  const double area = squared_norm(n);
  return origin + Vec2{dot(cross(p, edges[1]), n) / area, dot(cross(edges[0], p), n) / area};
}

std::array<Vec3, 2> Surface::texel_edges(std::uint32_t face) const {
  return impl_->maps[face].edges;
}

double Surface::utilisation() const {
  return static_cast<double>(impl_->samples.size()) / static_cast<double>(impl_->texel_faces.size());
}

const Coverage& coverage_of(const Surface& surface) {
  SurfaceData::Lazy& lazy = surface.impl().lazy;
  std::call_once(lazy.cut, [&] { lazy.coverage.emplace(surface); });
  return *lazy.coverage;
}

const Coverage::Radii& radii_of(const Surface& surface) {
  SurfaceData::Lazy& lazy = surface.impl().lazy;
  std::call_once(lazy.present->measured, [&] { coverage_of(surface).measure(surface, lazy.radii); });
  return lazy.radii;
}

std::span<const float> Surface::sample_radii() const {
  return radii_of(*this).samples;
}
std::span<const float> Surface::face_radii() const {
  return radii_of(*this).faces;
}
double Surface::sampling_bound() const {
  return radii_of(*this).largest;
}

}  // namespace sdm
