#include "atlas/texels.h"

#include <algorithm>
#include <cmath>

#include "atlas/rasterise.h"
#include "core/parallel.h"
#include "core/spatial_order.h"
#include "core/vec.h"

namespace sdm {
namespace {

// The bits of x (up to 15 of them) with a zero before each.
constexpr std::uint32_t spread_bits(std::uint32_t x) {
  x = (x | x << 8) & 0x00FF00FF;
  x = (x | x << 4) & 0x0F0F0F0F;
  x = (x | x << 2) & 0x33333333;
  return (x | x << 1) & 0x55555555;
}

std::uint32_t z_order(std::uint32_t x, std::uint32_t y) {
  return spread_bits(x) | spread_bits(y) << 1;
}

double atlas_area(const std::array<Vec2, 3>& t) {
  return std::abs(cross(t[1] - t[0], t[2] - t[0]));
}

// Calls visit(face, x, y) for each texel centre in the chart's faces.
template <class Visit>
void for_each_texel(const Layout& layout, const std::vector<std::uint32_t>& faces, Visit visit) {
  for (const std::uint32_t f : faces)
    for_each_centre(layout.corners[f], [&](std::uint32_t x, std::uint32_t y) { visit(f, x, y); });
}

// Packing puts the centroid of the largest face on a texel centre where no other lies in a face; with a face
// that is thinner than rounding, that centre may still fall beside it.
void claim_centroid(const Layout& layout, const std::vector<std::uint32_t>& faces, std::uint32_t resolution,
                    std::vector<std::uint32_t>& owner) {
  const auto smaller = [&](auto f, auto g) {
    return atlas_area(layout.corners[f]) < atlas_area(layout.corners[g]);
  };
  const std::uint32_t face = *std::max_element(faces.begin(), faces.end(), smaller);
  const auto& [a, b, c] = layout.corners[face];
  const Vec2 centroid = (1.0 / 3) * (a + b + c);
  owner[static_cast<std::size_t>(centroid[1]) * resolution + static_cast<std::size_t>(centroid[0])] = face;
}

}  // namespace

std::vector<std::uint32_t> rasterise(const Layout& layout, AtlasKind kind, std::uint32_t resolution) {
  std::vector<std::uint32_t> owner(std::size_t{resolution} * resolution, kNone);
  const auto rasterise_charts = [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      bool any = false;
      for_each_texel(layout, layout.charts[c], [&](std::uint32_t face, std::uint32_t x, std::uint32_t y) {
        if (x >= resolution || y >= resolution) return;  // rounding at the border of the image
        std::uint32_t& texel = owner[std::size_t{y} * resolution + x];
        if (texel == kNone) texel = face;
        any = true;
      });
      if (!any && kind != AtlasKind::uv) claim_centroid(layout, layout.charts[c], resolution, owner);
    }
  };
  // Packed charts share no texel; a mesh's own may overlap by rounding, so the first one in order has it.
  if (kind == AtlasKind::uv)
    rasterise_charts(0, layout.charts.size());
  else
    parallel_for(layout.charts.size(), 16, rasterise_charts);
  return owner;
}

std::vector<std::uint32_t> order_samples(const Mesh& mesh, const Layout& layout,
                                         const std::vector<std::uint32_t>& texel_faces,
                                         const std::vector<std::uint32_t>& face_charts,
                                         std::uint32_t resolution) {
  std::vector<Vec3> centres(layout.charts.size());
  for (std::size_t c = 0; c < centres.size(); ++c) {
    for (const std::uint32_t f : layout.charts[c]) centres[c] += mesh.positions[mesh.triangles[f][0]];
    centres[c] = (1.0 / static_cast<double>(layout.charts[c].size())) * centres[c];
  }
  const std::vector<std::uint32_t> order = spatial_order(centres);
  std::vector<std::uint32_t> rank(order.size());
  for (std::uint32_t r = 0; r < order.size(); ++r) rank[order[r]] = r;

  // A counting sort by chart, then each chart by itself.
  std::vector<std::size_t> offsets(order.size() + 1, 0);
  for (const std::uint32_t face : texel_faces)
    if (face != kNone) ++offsets[rank[face_charts[face]] + 1];
  for (std::size_t r = 1; r < offsets.size(); ++r) offsets[r] += offsets[r - 1];
  std::vector<std::uint32_t> samples(offsets.back());
  std::vector<std::size_t> next(offsets.begin(), offsets.end() - 1);
  for (std::size_t texel = 0; texel < texel_faces.size(); ++texel)
    if (texel_faces[texel] != kNone)
      samples[next[rank[face_charts[texel_faces[texel]]]]++] = static_cast<std::uint32_t>(texel);
  parallel_for(order.size(), 16, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint64_t> keys;
    for (std::size_t r = begin; r < end; ++r) {
      keys.clear();
      for (std::size_t i = offsets[r]; i < offsets[r + 1]; ++i)
        keys.push_back(std::uint64_t{z_order(samples[i] % resolution, samples[i] / resolution)} << 32 |
                       samples[i]);
      std::sort(keys.begin(), keys.end());
      for (std::size_t i = 0; i < keys.size(); ++i)
        samples[offsets[r] + i] = static_cast<std::uint32_t>(keys[i]);
    }
  });
  return samples;
}

}  // namespace sdm
