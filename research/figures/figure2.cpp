// Figure 2: the affine map of a triangle of O1, the closest sites of its samples, and Lemma 1.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "research/figures/affine_map.h"
#include "research/figures/charts/svg.h"
#include "research/figures/figures.h"
#include "research/figures/maps.h"
#include "research/figures/pieces.h"

namespace sdm::figures {
namespace {

/// O1, a triangle, and O2, two faces that meet in a ridge above it.
std::array<Mesh, 2> triangle_and_ridge() {
  return {
      Mesh{{{0, 0, 0}, {1.2, 0.1, 0.15}, {0.35, 0.95, 0.05}}, {{0, 1, 2}}, {}},
      Mesh{
          {{0.05, 0.3, 0.95}, {1, 0.4, 1}, {0.6, -0.4, 0.65}, {0.45, 1.1, 0.6}}, {{0, 1, 3}, {1, 0, 2}}, {}}};
}

/// A parallel projection of the scene to the page.
Vec2 on_page(const Vec3& p) {
  return {70 + 195 * (p[0] + 0.32 * p[1]), 330 - 150 * p[2] - 95 * (p[1] - 0.25 * p[0])};
}

io::Rgb type_color(SiteType type) {
  return kSeriesColors[type == SiteType::face ? 0 : type == SiteType::edge ? 1 : 3];
}

std::string in_space(const Surface& surface, const Sites& sites, const DistanceMap& map) {
  Svg svg(410, 400, "A triangle with its samples and the vectors to their closest sites");
  const auto outline = [&](const Mesh& mesh, io::Rgb fill, double opacity) {
    for (const auto& [a, b, c] : mesh.triangles) {
      const Vec2 corners[] = {on_page(mesh.positions[a]), on_page(mesh.positions[b]),
                              on_page(mesh.positions[c])};
      svg.polygon(corners, fill, opacity, {kAxisColor, 1.2});
    }
  };
  outline(surface.mesh(), {150, 190, 230}, 0.5);
  outline(sites.mesh(), {240, 200, 140}, 0.5);
  for (const std::uint32_t t : surface.sample_texels()) {
    const Vec3 q = surface.texel_point(t);
    const Vec3f& v = map.vector[t];
    svg.arrow(on_page(q), on_page(q + Vec3{v[0], v[1], v[2]}), {{0, 140, 80}, 0.9});
    svg.dot(on_page(q), 2.8, type_color(map.site_type[t]));
  }
  svg.text({20, 24}, "T of O1 below, O2 above", 14, "start", true);
  return std::move(svg).finished();
}

std::string in_atlas(const Surface& surface, const DistanceMap& map) {
  constexpr double kCell = 22, kLeft = 20, kTop = 40;
  const auto n = static_cast<double>(surface.resolution());
  Svg svg(2 * kLeft + n * kCell, kTop + n * kCell + 20, "The triangle in the atlas");
  svg.text({kLeft, 24}, "t = M T in the atlas", 14, "start", true);
  for (double i = 0; i <= n; ++i) {
    svg.line({kLeft + i * kCell, kTop}, {kLeft + i * kCell, kTop + n * kCell}, {kGridColor});
    svg.line({kLeft, kTop + i * kCell}, {kLeft + n * kCell, kTop + i * kCell}, {kGridColor});
  }
  const auto place = [&](const Vec2& uv) { return Vec2{kLeft + uv[0] * kCell, kTop + uv[1] * kCell}; };
  const auto [a, b, c] = surface.atlas_corners(0);
  const Vec2 corners[] = {place(a), place(b), place(c)};
  svg.polygon(corners, {150, 190, 230}, 0.5, {kAxisColor, 1.2});
  for (const std::uint32_t t : surface.sample_texels())
    svg.dot(place(texel_centre(surface, t)), 3.6, type_color(map.site_type[t]));
  return std::move(svg).finished();
}

/// What interpolating over triples of samples with a common closest site is wrong by, at the samples between.
struct Interpolation {
  std::size_t samples = 0;
  double vector_error = 0, scalar_error = 0;  ///< relative to the diagonal
};

/// Barycentric coordinates of p, or nothing outside of the triangle.
std::optional<Vec3> weights_in(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& p) {
  const double area = cross(b - a, c - a);
  if (std::abs(area) < 1) return std::nullopt;
  const double v = cross(p - a, c - a) / area, w = cross(b - a, p - a) / area;
  if (v < 0 || w < 0 || v + w > 1) return std::nullopt;
  return Vec3{1 - v - w, v, w};
}

Interpolation interpolate(const Pair& pair) {
  const Surface& surface = pair.sides[0].surface;
  const std::vector<Vec3> points = surface.sample_points();
  const std::vector<ClosestPoint> closest =
      closest_points(pair.sides[1].sites, points, {.engine = make_engine("reference")});
  const double unit = pair.diagonal();
  // Samples of one face of O1 with one closest site: they lie in its region, which is convex.
  std::map<std::array<std::uint32_t, 3>, std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < points.size(); ++i)
    groups[{surface.map_faces()[surface.sample_texels()[i]], static_cast<std::uint32_t>(closest[i].type),
            closest[i].site}]
        .push_back(i);
  const auto uv = [&](std::size_t i) { return texel_centre(surface, surface.sample_texels()[i]); };
  Interpolation result;
  for (const auto& entry : groups) {
    const std::vector<std::size_t>& group = entry.second;
    if (group.size() < 6) continue;
    const auto corner = [&](const Vec2& direction) {
      return *std::ranges::max_element(group, {}, [&](std::size_t i) { return dot(direction, uv(i)); });
    };
    const std::size_t a = corner({-1, -0.3}), b = corner({1, -0.4}), c = corner({0.1, 1});
    for (const std::size_t i : group) {
      const auto w = weights_in(uv(a), uv(b), uv(c), uv(i));
      if (!w || i == a || i == b || i == c) continue;
      const auto vector = [&](std::size_t k) { return closest[k].point - points[k]; };
      const Vec3 mixed = (*w)[0] * vector(a) + (*w)[1] * vector(b) + (*w)[2] * vector(c);
      const double scalar =
          (*w)[0] * closest[a].distance + (*w)[1] * closest[b].distance + (*w)[2] * closest[c].distance;
      ++result.samples;
      result.vector_error = std::max(result.vector_error, norm(mixed - vector(i)) / unit);
      result.scalar_error = std::max(result.scalar_error, std::abs(scalar - closest[i].distance) / unit);
    }
  }
  return result;
}

}  // namespace

Figure figure2(Run& run) {
  Pair small(triangle_and_ridge(), 16);
  small.compute();
  const Surface& triangle = small.sides[0].surface;
  const AffineMap m = affine_map(triangle, 0);
  double residual = 0;
  for (const std::uint32_t t : triangle.sample_texels()) {
    const Vec2 off = triangle.to_atlas(0, triangle.texel_point(t)) - texel_centre(triangle, t);
    residual = std::max({residual, std::abs(off[0]), std::abs(off[1])});
  }

  Pair letters(run.letters().meshes(0), run.choose(512u, 256u));
  const Interpolation lemma = interpolate(letters);

  Figure figure{
      .key = "figure2",
      .title = "Figure 2: affine map and distance computation",
      .paper =
          "M maps a triangle T of O1 to a triangle t of the 2D domain; a green vector shows the closest site "
          "of a point Q. Lemma 1: d(Q, P) of a site P, given at the corners of B ∩ T, equals its linear "
          "interpolation.",
      .measured = fmt::format(
          "The map of a triangle to the two faces above it, at 16². M = A_t A_s A_r with s_x = {:.3f}, s_y = "
          "{:.3f} texels per metre and shear {:.1e}; M maps each sample to the centre of its texel up to "
          "{:.0e} texels. Lemma 1 holds for vectors only: between samples of the letter E with a common "
          "closest site, interpolated vectors are wrong by at most {:.1e} of the diagonal, interpolated "
          "distances by up to {:.1e} ({} samples).",
          m.sx, m.sy, m.sh, residual, lemma.vector_error, lemma.scalar_error, lemma.samples)};
  const std::string types = fmt::format(
      R"(<p class="legend">Closest site: <span class="swatch"><i style="background:{}"></i>a face</span><span class="swatch"><i style="background:{}"></i>an edge</span><span class="swatch"><i style="background:{}"></i>a vertex</span></p>)"
      "\n",
      css(type_color(SiteType::face)), css(type_color(SiteType::edge)), css(type_color(SiteType::vertex)));
  figure.html = {
      row({panel(in_space(triangle, small.sides[1].sites, small.sides[0].map),
                 "The samples of T and their distance vectors"),
           panel(in_atlas(triangle, small.sides[0].map), "The same samples in the atlas, 16 × 16 texels")}),
      types};
  figure.comparisons = {{"Lemma 1, interpolated distances", "equal to the distance",
                         fmt::format("wrong by up to {:.1e} of the diagonal; vectors: {:.1e}",
                                     lemma.scalar_error, lemma.vector_error)}};
  figure.json = {{"paper", {{"vector_error", 0}, {"scalar_error", 0}}},
                 {"measured",
                  {{"scale", {m.sx, m.sy}},
                   {"shear", m.sh},
                   {"texel_residual", residual},
                   {"samples", lemma.samples},
                   {"vector_error", lemma.vector_error},
                   {"scalar_error", lemma.scalar_error}}}};
  return figure;
}

}  // namespace sdm::figures
