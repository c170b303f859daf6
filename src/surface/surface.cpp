#include <sdm/error.h>

#include <algorithm>
#include <string>
#include <utility>

#include "atlas/packing/too_small.h"
#include "atlas/texel_owners.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "core/spatial_order.h"
#include "core/vec.h"
#include "mesh/validate.h"
#include "surface/surface_data.h"

namespace sdm {
namespace {

constexpr std::uint32_t kMinResolution = 16, kMaxResolution = 32768;

void check(const Mesh& mesh, const AtlasOptions& options) {
  validate(mesh);
  const std::uint32_t n = options.resolution;
  if (n < kMinResolution || n > kMaxResolution)
    throw Error("an atlas resolution of " + std::to_string(n) + " is out of range; use 16 to 32768",
                Remedy::resolution);
  if (!(options.max_stretch > 1))
    throw Error("a maximum stretch of " + std::to_string(options.max_stretch) +
                " is out of range; use more than 1");
  if (options.gutter > n / 4)
    throw Error("a gutter of " + std::to_string(options.gutter) + " texels is too wide for an atlas of " +
                std::to_string(n) + "² texels; use a quarter of that at most");
  // The texel table, its order and its points, and the chart and layout data of each face.
  constexpr std::size_t kBytesPerTexel = 64, kBytesPerFace = 600;
  require_memory(kBytesPerTexel * n * n + kBytesPerFace * mesh.triangles.size(), "the atlas");
}

Vec3 point_at(const surface::SurfaceData& surface, std::uint32_t face, const Vec2& uv) {
  const atlas::FaceMap& map = surface.maps[face];
  const Vec2 d = uv - map.origin;
  return surface.mesh.positions[surface.mesh.triangles[face][0]] + d[0] * map.edges[0] + d[1] * map.edges[1];
}

Vec3 point_of(const surface::SurfaceData& surface, std::uint32_t face, std::uint32_t texel) {
  const Vec2 centre = {texel % surface.resolution + 0.5, texel / surface.resolution + 0.5};
  return point_at(surface, face, centre);
}

void find_sample_faces(surface::SurfaceData& surface) {
  surface.sample_faces.resize(surface.samples.size());
  std::ranges::transform(surface.samples, surface.sample_faces.begin(),
                         [&](std::uint32_t texel) { return surface.texel_faces[texel]; });
}

// Sets `points` to those of all samples.
void place_all(const surface::SurfaceData& surface, std::vector<Vec3>& points) {
  points.resize(surface.samples.size());
  parallel_for(points.size(), 4096, [&](std::size_t begin, std::size_t end) {
    surface::place_samples(surface, begin, std::span(points).subspan(begin, end - begin));
  });
}

// Puts the samples into an order in space.
void order_samples(surface::SurfaceData& surface) {
  find_sample_faces(surface);
  std::vector<Vec3> points;
  place_all(surface, points);
  std::vector<std::uint32_t> order = spatial_order(points);
  for (std::uint32_t& index : order) index = surface.samples[index];
  surface.samples = std::move(order);
  find_sample_faces(surface);
}

}  // namespace

void surface::place_samples(const surface::SurfaceData& surface, std::size_t first, std::span<Vec3> points) {
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] = point_of(surface, surface.sample_faces[first + i], surface.samples[first + i]);
}

Surface::Surface(Mesh mesh, const AtlasOptions& options) {
  check(mesh, options);
  atlas::Layout layout =
      options.kind == AtlasKind::uv ? atlas::uv_layout(mesh, options) : atlas::chart_layout(mesh, options);
  std::vector<std::uint32_t> face_charts(mesh.triangles.size(), kNone);
  for (std::uint32_t c = 0; c < layout.charts.size(); ++c)
    for (const std::uint32_t f : layout.charts[c]) face_charts[f] = c;
  std::vector<std::uint32_t> texel_faces = atlas::rasterise(layout, options.kind, options.resolution);
  std::vector<std::uint32_t> samples = atlas::owned_texels(texel_faces);
  if (samples.empty())
    throw atlas::TooSmall(
        "no face of the mesh is large enough in the texture to own a texel; use a larger resolution",
        2 * options.resolution);
  data_ = std::make_unique<surface::SurfaceData>();
  data_->mesh = std::move(mesh);
  data_->kind = options.kind;
  data_->resolution = options.resolution;
  data_->chart_count = layout.charts.size();
  data_->max_stretch = layout.max_stretch;
  data_->maps = std::move(layout.maps);
  data_->corners = std::move(layout.corners);
  data_->face_charts = std::move(face_charts);
  data_->texel_faces = std::move(texel_faces);
  data_->samples = std::move(samples);
  order_samples(*data_);
}

void Surface::refit(std::span<const Vec3> positions) {
  surface::SurfaceData& s = *data_;
  std::vector<Vec3>& current = s.mesh.positions;
  mesh::validate_positions(positions, current.size());
  parallel_for(s.mesh.triangles.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const Triangle& t = s.mesh.triangles[f];
      const bool moved = std::ranges::any_of(t, [&](std::uint32_t v) { return positions[v] != current[v]; });
      if (moved && s.face_charts[f] != kNone)
        s.maps[f].edges = atlas::affine_edges(s.corners[f], positions, t);
    }
  });
  std::ranges::copy(positions, current.begin());
  s.lazy.present.emplace();
}

Surface::~Surface() = default;
Surface::Surface(Surface&&) noexcept = default;
Surface& Surface::operator=(Surface&&) noexcept = default;

const Mesh& Surface::mesh() const {
  return data_->mesh;
}
AtlasKind Surface::atlas_kind() const {
  return data_->kind;
}
std::uint32_t Surface::resolution() const {
  return data_->resolution;
}
std::span<const std::uint32_t> Surface::texel_faces() const {
  return data_->texel_faces;
}
std::span<const std::uint32_t> Surface::sample_texels() const {
  return data_->samples;
}
std::span<const Vec3> Surface::sample_points() const {
  surface::SurfaceData::Lazy& lazy = data_->lazy;
  std::call_once(lazy.present->placed, [&] { place_all(*data_, lazy.sample_points); });
  return lazy.sample_points;
}
std::size_t Surface::chart_count() const {
  return data_->chart_count;
}
std::span<const std::uint32_t> Surface::face_charts() const {
  return data_->face_charts;
}
double Surface::max_stretch() const {
  return data_->max_stretch;
}

Vec3 Surface::texel_point(std::uint32_t texel) const {
  return point_of(*data_, data_->texel_faces[texel], texel);
}

Vec3 Surface::to_surface(std::uint32_t face, const Vec2& uv) const {
  return point_at(*data_, face, uv);
}

// Solves p − vertex 0 = a ∂p/∂u + b ∂p/∂v in the plane of the two, with normal n = ∂p/∂u × ∂p/∂v: a |n|² = (p
// × ∂p/∂v)·n, b |n|² = (∂p/∂u × p)·n.
Vec2 Surface::to_atlas(std::uint32_t face, const Vec3& point) const {
  const auto& [origin, edges] = data_->maps[face];
  const Vec3 p = point - data_->mesh.positions[data_->mesh.triangles[face][0]];
  const Vec3 n = cross(edges[0], edges[1]);
  const double area = squared_norm(n);
  return origin + Vec2{dot(cross(p, edges[1]), n) / area, dot(cross(edges[0], p), n) / area};
}

std::array<Vec3, 2> Surface::texel_edges(std::uint32_t face) const {
  return data_->maps[face].edges;
}

double Surface::utilisation() const {
  return static_cast<double>(data_->samples.size()) / static_cast<double>(data_->texel_faces.size());
}

const surface::Coverage& surface::coverage_of(const Surface& surface) {
  surface::SurfaceData::Lazy& lazy = internals(surface).lazy;
  std::call_once(lazy.cut, [&] { lazy.coverage.emplace(surface); });
  return *lazy.coverage;
}

const surface::Coverage::Radii& surface::radii_of(const Surface& surface) {
  surface::SurfaceData::Lazy& lazy = internals(surface).lazy;
  std::call_once(lazy.present->measured, [&] { surface::coverage_of(surface).measure(surface, lazy.radii); });
  return lazy.radii;
}

std::span<const float> Surface::sample_radii() const {
  return surface::radii_of(*this).samples;
}
std::span<const float> Surface::face_radii() const {
  return surface::radii_of(*this).faces;
}
double Surface::sampling_bound() const {
  return surface::radii_of(*this).largest;
}

}  // namespace sdm
