#include "atlas/texel_owners.h"

#include <algorithm>
#include <cmath>

#include "atlas/packing/rasterise.h"
#include "core/parallel.h"

namespace sdm::atlas {
namespace {

double atlas_area(const std::array<Vec2, 3>& t) {
  return std::abs(cross(t[1] - t[0], t[2] - t[0]));
}

using Corners = std::vector<std::array<Vec2, 3>>;

// Calls visit(face, x, y) for each texel centre in the chart's faces.
template <class Visit>
void for_each_texel(const Corners& corners, const std::vector<std::uint32_t>& faces, Visit visit) {
  for (const std::uint32_t f : faces)
    for_each_centre(corners[f], [&](std::uint32_t x, std::uint32_t y) { visit(f, x, y); });
}

// Packing puts the centroid of the largest face on a texel centre where no other lies in a face; for a face
// thinner than rounding errors, that centre may still fall beside it. Returns the texel.
std::size_t claim_centroid(const Corners& corners, const std::vector<std::uint32_t>& faces,
                           std::uint32_t resolution, std::vector<std::uint32_t>& owner) {
  const auto smaller = [&](auto f, auto g) { return atlas_area(corners[f]) < atlas_area(corners[g]); };
  const std::uint32_t face = *std::max_element(faces.begin(), faces.end(), smaller);
  const auto& [a, b, c] = corners[face];
  const Vec2 centroid = (1.0 / 3) * (a + b + c);
  const std::size_t texel =
      static_cast<std::size_t>(centroid[1]) * resolution + static_cast<std::size_t>(centroid[0]);
  owner[texel] = face;
  return texel;
}

// Whether the centre of a texel is farther inside the triangle than rounding takes it: by 1/1024 of a texel.
bool is_well_inside(const std::array<Vec2, 3>& t, std::uint32_t x, std::uint32_t y) {
  constexpr double kTexelRounding = 1.0 / 1024;
  const Vec2 centre{x + 0.5, y + 0.5};
  const double turn = cross(t[1] - t[0], t[2] - t[0]) < 0 ? -1 : 1;
  for (int k = 0; k < 3; ++k) {
    const Vec2 edge = t[(k + 1) % 3] - t[k];
    if (!(turn * cross(edge, centre - t[k]) > kTexelRounding * std::hypot(edge[0], edge[1]))) return false;
  }
  return true;
}

}  // namespace

std::vector<std::uint32_t> rasterise(const Layout& layout, AtlasKind kind, std::uint32_t resolution,
                                     std::uint32_t rows, std::size_t& overlapping) {
  overlapping = 0;
  std::vector<std::uint32_t> owner(std::size_t{resolution} * rows, kNone);
  const auto rasterise_charts = [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      bool any = false;
      for_each_texel(layout.corners, layout.charts[c],
                     [&](std::uint32_t face, std::uint32_t x, std::uint32_t y) {
                       if (x >= resolution || y >= rows) return;  // rounding at the border of the image
                       std::uint32_t& texel = owner[std::size_t{y} * resolution + x];
                       any = true;
                       if (texel == kNone)
                         texel = face;
                       else if (kind == AtlasKind::uv && is_well_inside(layout.corners[face], x, y))
                         ++overlapping;
                     });
      if (!any && kind != AtlasKind::uv) claim_centroid(layout.corners, layout.charts[c], resolution, owner);
    }
  };
  // Packed charts share no texel. A mesh's own charts may overlap: the first one, in order, owns the texel.
  if (kind == AtlasKind::uv)
    rasterise_charts(0, layout.charts.size());
  else
    parallel_for(layout.charts.size(), 16, rasterise_charts);
  return owner;
}

std::vector<std::uint32_t> rasterise_added(std::span<const std::vector<std::uint32_t>> charts,
                                           const Corners& corners, std::uint32_t resolution,
                                           std::vector<std::uint32_t>& owner) {
  std::vector<std::uint32_t> texels;
  const std::size_t rows = owner.size() / resolution;
  for (const std::vector<std::uint32_t>& chart : charts) {
    const std::size_t before = texels.size();
    for_each_texel(corners, chart, [&](std::uint32_t face, std::uint32_t x, std::uint32_t y) {
      if (x >= resolution || y >= rows) return;  // rounding at the border of the image
      const std::size_t texel = std::size_t{y} * resolution + x;
      if (owner[texel] != kNone) return;
      owner[texel] = face;
      texels.push_back(static_cast<std::uint32_t>(texel));
    });
    if (texels.size() == before)
      texels.push_back(static_cast<std::uint32_t>(claim_centroid(corners, chart, resolution, owner)));
  }
  return texels;
}

}  // namespace sdm::atlas
