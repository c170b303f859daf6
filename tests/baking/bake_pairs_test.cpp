// Base colours against brute force, at every texel of small pairs.
#include <gtest/gtest.h>
#include <sdm/bake.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "support/match_pairs.h"
#include "support/owned_texels.h"

namespace sdm::test {
namespace {

/// The weights of the closest point of a triangle, by the regions of its plane (C. Ericson, Real-Time
/// Collision Detection, 5.1.5).
Vec3 closest_weights(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a;
  const double d1 = dot(ab, p - a), d2 = dot(ac, p - a);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const double d3 = dot(ab, p - b), d4 = dot(ac, p - b);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
  const double d5 = dot(ab, p - c), d6 = dot(ac, p - c);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - w, w};
  }
  const double sum = va + vb + vc;
  return {va / sum, vb / sum, vc / sum};
}

/// Smooth in space, so that points next to each other on O2 have nearly the same colour.
Vec3 color_at(const Vec3& p) {
  Vec3 color;
  for (int k = 0; k < 3; ++k) color[k] = 0.5 + 0.3 * std::sin(2 * p[k] + 0.7 * p[(k + 1) % 3] + k);
  return color;
}

struct Nearest {
  std::uint32_t face;
  double distance;
  Vec3 weights;
};

/// The closest point of every face that is within rounding of the closest of all.
std::vector<Nearest> nearest_faces(const Mesh& mesh, const Vec3& p) {
  std::vector<Nearest> all;
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    const auto& [ia, ib, ic] = mesh.triangles[f];
    const Vec3 &a = mesh.positions[ia], &b = mesh.positions[ib], &c = mesh.positions[ic];
    const Vec3 w = closest_weights(p, a, b, c);
    all.push_back({f, norm(w[0] * a + w[1] * b + w[2] * c - p), w});
    least = std::min(least, all.back().distance);
  }
  std::erase_if(all, [&](const Nearest& n) { return n.distance > least + 1e-5; });
  return all;
}

TEST(BakePairs, EveryTexelHasTheColorOfTheClosestPointOfBruteForce) {
  const auto pairs = pairs_to_match();
  ASSERT_EQ(pairs.size(), 40u);
  std::size_t texels = 0, wrong = 0, alone = 0;
  for (const auto& [o1, o2] : pairs) {
    // The colour of a point is that of its vertices, interpolated, times that of the material of its face.
    std::vector<Material> materials(3);
    for (std::size_t m = 0; m < materials.size(); ++m) materials[m].base_color[m] = 0.25f;
    std::vector<std::uint32_t> of_faces(o2.triangles.size());
    for (std::size_t f = 0; f < of_faces.size(); ++f) of_faces[f] = static_cast<std::uint32_t>(f * 7 % 3);
    std::vector<MeshAttribute> attributes{{.name = "color",
                                           .components = 3,
                                           .values = {},
                                           .rows = std::make_shared<std::vector<Triangle>>(o2.triangles)}};
    for (const Vec3& p : o2.positions)
      for (const double x : color_at(p)) attributes[0].values.push_back(static_cast<float>(x));

    const Surface surface(o1, {.resolution = 24});
    const Sites sites(o2);
    const BakedChannel baked =
        bake(surface, sites, match_texels(surface, sites, {.method = MatchMethod::closest}),
             {.materials = materials, .face_materials = of_faces, .attributes = attributes},
             std::array{BakeChannel::base_color})
            .front();
    for (const std::uint32_t texel : test::owned_texels(surface)) {
      ++texels;
      const auto nearest = nearest_faces(o2, surface.texel_point(texel));
      alone += nearest.size() == 1;
      const bool found = std::ranges::any_of(nearest, [&](const Nearest& n) {
        for (std::size_t k = 0; k < 3; ++k) {
          double expected = 0;
          for (std::size_t corner = 0; corner < 3; ++corner)
            expected += n.weights[corner] * attributes[0].values[3 * o2.triangles[n.face][corner] + k];
          expected *= materials[of_faces[n.face]].base_color[k];
          if (!(std::abs(baked.values[3 * std::size_t{texel} + k] - expected) < 1e-4)) return false;
        }
        return true;
      });
      wrong += !found;
    }
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_GT(texels, 8000u);
  EXPECT_GT(alone, texels / 2);  // one face decides the colour
}

}  // namespace
}  // namespace sdm::test
