#include "atlas/invariants.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "geometry/vec.h"

namespace sdm::test {
namespace {

std::array<Vec3, 3> corners(const Mesh& mesh, std::uint32_t face) {
  const auto [i, j, k] = mesh.triangles[face];
  return {mesh.positions[i], mesh.positions[j], mesh.positions[k]};
}

std::array<Vec2, 3> mapped(const Surface& surface, std::uint32_t face) {
  const auto p = corners(surface.mesh(), face);
  return {surface.to_atlas(face, p[0]), surface.to_atlas(face, p[1]), surface.to_atlas(face, p[2])};
}

bool has_area(const Mesh& mesh, std::uint32_t face) {
  const auto [a, b, c] = corners(mesh, face);
  return cross(b - a, c - a) != Vec3{};
}

// The depth of p inside the triangle: the least distance to the lines of its edges, negative outside of one.
double depth(const std::array<Vec2, 3>& t, const Vec2& p) {
  const double turn = cross(t[1] - t[0], t[2] - t[0]) < 0 ? -1 : 1;
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const Vec2 edge = t[(k + 1) % 3] - t[k];
    const double length = std::hypot(edge[0], edge[1]);
    if (length > 0) least = std::min(least, turn * cross(edge, p - t[k]) / length);
  }
  return least;
}

double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const double t = std::clamp(dot(p - a, b - a) / squared_norm(b - a), 0.0, 1.0);
  return norm(p - (a + t * (b - a)));
}

// Inside the prism over the triangle the distance to its plane, else to the nearest edge.
double distance_to_triangle(const Vec3& p, const std::array<Vec3, 3>& t) {
  const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
  bool inside = true;
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const Vec3 &a = t[k], &b = t[(k + 1) % 3];
    inside = inside && dot(cross(n, b - a), p - a) >= 0;
    least = std::min(least, distance_to_segment(p, a, b));
  }
  return inside ? std::min(least, std::abs(dot(normalized(n), p - t[0]))) : least;
}

std::set<std::uint32_t> owning_charts(const Surface& surface) {
  std::set<std::uint32_t> charts;
  for (const std::uint32_t face : surface.texel_faces())
    if (face != kNone) charts.insert(surface.face_charts()[face]);
  return charts;
}

// The charts, but for `own`, that own a texel within `reach` of (x, y).
std::size_t strangers_near(const Surface& surface, std::int64_t x, std::int64_t y, std::int64_t reach,
                           std::uint32_t own) {
  const auto n = static_cast<std::int64_t>(surface.resolution());
  std::size_t count = 0;
  for (std::int64_t j = std::max<std::int64_t>(0, y - reach);
       j <= std::min<std::int64_t>(surface.rows() - 1, y + reach); ++j)
    for (std::int64_t i = std::max<std::int64_t>(0, x - reach); i <= std::min(n - 1, x + reach); ++i) {
      const std::uint32_t face = surface.map_faces()[static_cast<std::size_t>(j * n + i)];
      count += face != kNone && surface.face_charts()[face] != own;
    }
  return count;
}

}  // namespace

void expect_charts(const Surface& surface) {
  std::size_t wrong = 0;
  std::set<std::uint32_t> charts;
  for (std::uint32_t f = 0; f < surface.mesh().triangles.size(); ++f) {
    const std::uint32_t chart = surface.face_charts()[f];
    wrong += has_area(surface.mesh(), f) != (chart != kNone);
    if (chart != kNone) charts.insert(chart);
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(charts.size(), surface.chart_count());
  EXPECT_EQ(*charts.rbegin() + 1, surface.chart_count());
  if (surface.atlas_kind() != AtlasKind::uv) {
    EXPECT_EQ(owning_charts(surface), charts);
  }
}

void expect_owners(const Surface& surface) {
  constexpr double kTexels = 1e-6;  // rounding
  const auto n = static_cast<std::int64_t>(surface.resolution());
  const double length = diagonal(bounds(surface.mesh()));
  std::size_t cracks = 0, strays = 0, off = 0;
  for (std::uint32_t f = 0; f < surface.mesh().triangles.size(); ++f) {
    if (surface.face_charts()[f] == kNone) continue;
    const auto t = mapped(surface, f);
    const auto [left, right] = std::minmax({t[0][0], t[1][0], t[2][0]});
    const auto [top, bottom] = std::minmax({t[0][1], t[1][1], t[2][1]});
    for (auto y = std::max<std::int64_t>(0, static_cast<std::int64_t>(top));
         y < std::min<std::int64_t>(surface.rows(), static_cast<std::int64_t>(bottom) + 1); ++y)
      for (auto x = std::max<std::int64_t>(0, static_cast<std::int64_t>(left));
           x < std::min(n, static_cast<std::int64_t>(right) + 1); ++x) {
        const Vec2 centre = {static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5};
        if (depth(t, centre) > kTexels && surface.map_faces()[static_cast<std::size_t>(y * n + x)] != f)
          ++cracks;
      }
  }
  for (const std::uint32_t texel : surface.sample_texels()) {
    const std::uint32_t f = surface.map_faces()[texel];
    const std::int64_t x = texel % n, y = texel / n;
    const Vec2 centre = {static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5};
    if (y < surface.rows()) strays += depth(mapped(surface, f), centre) < -kTexels;
    off += !(distance_to_triangle(surface.texel_point(texel), corners(surface.mesh(), f)) <= 1e-9 * length);
  }
  EXPECT_EQ(cracks, 0u);
  EXPECT_EQ(strays, 0u);
  EXPECT_EQ(off, 0u);
}

void expect_gutters(const Surface& surface, std::uint32_t gutter) {
  const auto n = surface.resolution();
  std::size_t close = 0;
  for (const std::uint32_t texel : surface.sample_texels())
    if (texel < surface.texel_faces().size())
      close += strangers_near(surface, texel % n, texel / n, std::int64_t{2} * gutter,
                              surface.face_charts()[surface.map_faces()[texel]]);
  EXPECT_EQ(close, 0u);
  // A corner's texel need not be owned, but keeps the distance.
  std::size_t touching = 0, outside = 0;
  for (std::uint32_t f = 0; f < surface.mesh().triangles.size(); ++f) {
    if (surface.face_charts()[f] == kNone) continue;
    const auto t = mapped(surface, f);
    for (const Vec2& p : t) {
      // Of the texels on both sides of a line, the one that the face reaches into.
      const Vec2 q = p + 1e-6 * ((1.0 / 3) * (t[0] + t[1] + t[2]) - p);
      const auto x = static_cast<std::int64_t>(q[0]), y = static_cast<std::int64_t>(q[1]);
      touching += strangers_near(surface, x, y, gutter, surface.face_charts()[f]);
      outside += p[0] < gutter - 1e-6 || p[1] < gutter - 1e-6 || p[0] > n - gutter + 1e-6 ||
                 p[1] > surface.rows() - gutter + 1e-6;
    }
  }
  EXPECT_EQ(touching, 0u);
  EXPECT_EQ(outside, 0u);
}

void expect_maps(const Surface& surface) {
  const double length = diagonal(bounds(surface.mesh()));
  double worst_point = 0, worst_uv = 0, worst_edges = 0;
  std::size_t mirrored = 0;
  for (std::uint32_t f = 0; f < surface.mesh().triangles.size(); ++f) {
    if (surface.face_charts()[f] == kNone) continue;
    const auto p = corners(surface.mesh(), f);
    const auto t = mapped(surface, f);
    for (int k = 0; k < 3; ++k) worst_point = std::max(worst_point, norm(surface.to_surface(f, t[k]) - p[k]));
    const Vec2 uv = {3.25, 17.5};
    const Vec3 point = surface.to_surface(f, uv);
    const Vec2 back = surface.to_atlas(f, point) - uv;
    worst_uv = std::max(worst_uv, std::hypot(back[0], back[1]));
    const auto edges = surface.texel_edges(f);
    worst_edges = std::max({worst_edges, norm(surface.to_surface(f, {4.25, 17.5}) - point - edges[0]),
                            norm(surface.to_surface(f, {3.25, 18.5}) - point - edges[1])});
    // Counter-clockwise from outside is clockwise in (u, v) as numbers, since v runs down.
    if (surface.atlas_kind() != AtlasKind::uv) mirrored += cross(t[1] - t[0], t[2] - t[0]) > 1e-6;
  }
  EXPECT_LE(worst_point, 1e-9 * length);
  EXPECT_LE(worst_uv, 1e-6);
  EXPECT_LE(worst_edges, 1e-9 * length);
  EXPECT_EQ(mirrored, 0u);
}

void expect_stretch(const Surface& surface) {
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (std::uint32_t f = 0; f < surface.mesh().triangles.size(); ++f) {
    if (surface.face_charts()[f] == kNone) continue;
    const auto [du, dv] = surface.texel_edges(f);
    // Eigenvalues of the first fundamental form.
    const double e = dot(du, du), g = dot(dv, dv), h = std::hypot((e - g) / 2, dot(du, dv));
    most = std::max(most, std::sqrt((e + g) / 2 + h));
    least = std::min(least, std::sqrt((e + g) / 2 - h));
  }
  EXPECT_NEAR(most / least, surface.max_stretch(), 1e-6 * surface.max_stretch());
}

void expect_samples(const Surface& surface) {
  std::vector<std::uint32_t> sorted(surface.sample_texels().begin(), surface.sample_texels().end()), owned;
  std::sort(sorted.begin(), sorted.end());
  std::set<std::uint32_t> faces;
  for (std::uint32_t i = 0; i < surface.map_faces().size(); ++i)
    if (surface.map_faces()[i] != kNone) {
      owned.push_back(i);
      faces.insert(surface.map_faces()[i]);
    }
  EXPECT_EQ(sorted, owned);
  EXPECT_EQ(static_cast<std::ptrdiff_t>(faces.size()),
            std::ranges::count_if(surface.face_charts(), [](std::uint32_t chart) { return chart != kNone; }))
      << "every face with an area has a sample";
  EXPECT_EQ(surface.owned_texels(),
            owned.size() - (surface.map_faces().size() - surface.texel_faces().size()));
  EXPECT_DOUBLE_EQ(surface.utilisation() * static_cast<double>(surface.texel_faces().size()),
                   static_cast<double>(surface.owned_texels()));
}

}  // namespace sdm::test
