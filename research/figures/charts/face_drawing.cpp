#include "research/figures/charts/face_drawing.h"

#include <algorithm>
#include <array>
#include <vector>

#include "research/figures/affine_map.h"
#include "research/figures/charts/svg.h"

namespace sdm::figures {
namespace {

constexpr double kSide = 14, kTitleHeight = 36, kMost = 640;

std::string draw(std::string_view title, const std::vector<std::array<Vec2, 3>>& faces,
                 const std::vector<Vec2>& samples, double per_unit) {
  Vec2 lo = faces[0][0], hi = lo;
  for (const auto& face : faces)
    for (const Vec2& c : face)
      for (int k = 0; k < 2; ++k) {
        lo[k] = std::min(lo[k], c[k]);
        hi[k] = std::max(hi[k], c[k]);
      }
  const double size = std::min(per_unit, kMost / (hi[0] - lo[0]));
  const double title_width = 8.0 * static_cast<double>(title.size());
  const auto place = [&](const Vec2& p) {
    return Vec2{kSide + size * (p[0] - lo[0]), kTitleHeight + size * (hi[1] - p[1])};
  };
  Svg svg(2 * kSide + std::max(title_width, size * (hi[0] - lo[0])),
          kTitleHeight + size * (hi[1] - lo[1]) + 14, title);
  svg.text({kSide, 22}, title, 14, "start", true);
  for (const auto& [a, b, c] : faces) {
    const Vec2 corners[] = {place(a), place(b), place(c)};
    svg.polygon(corners, {150, 190, 230}, 0.5, {kAxisColor, 1});
  }
  for (const Vec2& s : samples) svg.dot(place(s), 2.6, kText);
  return std::move(svg).finished();
}

}  // namespace

std::string faces_with_samples(std::string_view title, const Surface& surface, double per_unit) {
  const auto flat = [](const Vec3& p) { return Vec2{p[0], p[1]}; };
  const Mesh& mesh = surface.mesh();
  std::vector<std::array<Vec2, 3>> faces;
  for (const auto& [a, b, c] : mesh.triangles)
    faces.push_back({flat(mesh.positions[a]), flat(mesh.positions[b]), flat(mesh.positions[c])});
  std::vector<Vec2> samples;
  for (const Vec3& s : surface.sample_points()) samples.push_back(flat(s));
  return draw(title, faces, samples, per_unit);
}

std::string atlas_with_samples(std::string_view title, const Surface& surface, double per_texel) {
  std::vector<std::array<Vec2, 3>> faces;
  for (std::uint32_t f = 0; f < surface.mesh().triangles.size(); ++f) {
    std::array<Vec2, 3> corners = surface.atlas_corners(f);
    for (Vec2& c : corners) c[1] = -c[1];  // rows of the atlas run down
    faces.push_back(corners);
  }
  std::vector<Vec2> samples;
  for (const std::uint32_t t : surface.sample_texels()) {
    if (t >= surface.texel_faces().size()) continue;
    const Vec2 centre = texel_centre(surface, t);
    samples.push_back({centre[0], -centre[1]});
  }
  return draw(title, faces, samples, per_texel);
}

}  // namespace sdm::figures
