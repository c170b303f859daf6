// The geometry of O2 as textures of O1.
#include <gtest/gtest.h>
#include <sdm/bake.h>
#include <sdm/match.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "support/error_of.h"
#include "support/owned_texels.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

Vec3 vector_at(const std::vector<float>& values, std::uint32_t texel) {
  return {values[3 * texel], values[3 * texel + 1], values[3 * texel + 2]};
}

double degrees_between(const Vec3& a, const Vec3& b) {
  return std::atan2(norm(cross(a, b)), dot(a, b)) / kDegree;
}

Vec3 point_of_match(const Mesh& mesh, const SurfacePoint& at) {
  Vec3 sum{};
  for (int k = 0; k < 3; ++k) sum += at.barycentric[k] * mesh.positions[mesh.triangles[at.face][k]];
  return sum;
}

/// A sphere with bumps, of 20 · 4^levels faces.
Mesh bumpy(int levels) {
  Mesh mesh = sphere(levels);
  for (Vec3& p : mesh.positions)
    p = (1 + 0.03 * std::sin(7 * p[0] + 1) * std::cos(9 * p[1]) * std::sin(8 * p[2])) * p;
  return mesh;
}

/// Reads a normal map as a renderer does: independent of what wrote it. Weights are areas in the atlas.
class NormalMapReader {
 public:
  NormalMapReader(const Surface& surface, const MeshAttribute& normals, const MeshAttribute& tangents)
      : surface_(surface), normals_(normals), tangents_(tangents) {}

  /// The normal of a texel from its numbers, stored with this many bits.
  [[nodiscard]] Vec3 read(std::uint32_t texel, const Vec3& coordinates, int bits) const {
    const std::uint32_t face = surface_.map_faces()[texel];
    const auto corners = surface_.atlas_corners(face);
    const Vec2 at{texel % surface_.resolution() + 0.5, texel / surface_.resolution() + 0.5};
    const double area = cross(corners[1] - corners[0], corners[2] - corners[0]);
    Vec3 n{}, t{};
    double w = 0;
    for (int k = 0; k < 3; ++k) {
      const double weight = cross(corners[(k + 1) % 3] - at, corners[(k + 2) % 3] - at) / area;
      const float* const normal = &normals_.values[3 * (*normals_.rows)[face][k]];
      const float* const tangent = &tangents_.values[4 * (*tangents_.rows)[face][k]];
      n += weight * Vec3{normal[0], normal[1], normal[2]};
      t += weight * Vec3{tangent[0], tangent[1], tangent[2]};
      w = tangent[3];
    }
    const double most = std::pow(2.0, bits) - 1;
    Vec3 stored{};
    for (int k = 0; k < 3; ++k) stored[k] = std::round((coordinates[k] * 0.5 + 0.5) * most) / most * 2 - 1;
    return normalized(stored[0] * t + stored[1] * (w * cross(n, t)) + stored[2] * n);
  }

 private:
  const Surface& surface_;
  const MeshAttribute &normals_, &tangents_;
};

TEST(BakedGeometry, TangentSpaceNormalsDecodeToThoseOfTheOtherMesh) {
  if (!has_tangents()) GTEST_SKIP() << "without MikkTSpace";
  const Mesh high = bumpy(5);
  const Sites sites(high);
  const MeshAttribute of_high = smooth_normals(high);
  for (const Mesh& low : {sphere(1), sphere(2), with_own_uvs(sphere(2))}) {
    const Surface surface(
        low, {.kind = low.corner_uvs.empty() ? AtlasKind::charts : AtlasKind::uv, .resolution = 128});
    const MeshAttribute normals = smooth_normals(low), frame = tangents(surface, normals);
    const TexelMatches matches = match_texels(surface, sites, {.method = MatchMethod::ray});
    const std::vector<float> wanted = matched_normals(surface, sites, matches, of_high);
    const std::vector<float> coordinates = tangent_space_normals(surface, normals, frame, wanted);
    const NormalMapReader reader(surface, normals, frame);
    double worst_of_8 = 0, worst_of_16 = 0;
    for (const std::uint32_t texel : test::owned_texels(surface)) {
      // The normal of the other mesh there, computed from its vertices.
      const SurfacePoint at = matches.point(texel);
      Vec3 normal{};
      for (int k = 0; k < 3; ++k) {
        const float* const n = &of_high.values[3 * (*of_high.rows)[at.face][k]];
        normal += at.barycentric[k] * Vec3{n[0], n[1], n[2]};
      }
      ASSERT_LE(degrees_between(normal, vector_at(wanted, texel)), 1e-4);
      ASSERT_NEAR(norm(vector_at(coordinates, texel)), 1, 1e-6);
      worst_of_8 =
          std::max(worst_of_8, degrees_between(normal, reader.read(texel, vector_at(coordinates, texel), 8)));
      worst_of_16 = std::max(worst_of_16,
                             degrees_between(normal, reader.read(texel, vector_at(coordinates, texel), 16)));
    }
    EXPECT_LE(worst_of_8, 0.7);
    EXPECT_LE(worst_of_16, 0.1);
    RecordProperty("degrees_at_8_bits_" + std::to_string(low.triangles.size()), std::to_string(worst_of_8));
    RecordProperty("degrees_at_16_bits_" + std::to_string(low.triangles.size()), std::to_string(worst_of_16));
  }
}

TEST(BakedGeometry, TangentsPointToTheRightOfTheTexture) {
  if (!has_tangents()) GTEST_SKIP() << "without MikkTSpace";
  for (const bool mirrored : {false, true}) {
    Mesh mesh = square(1, 0);
    for (const Triangle& t : mesh.triangles) {
      std::array<Vec2, 3>& uvs = mesh.corner_uvs.emplace_back();
      for (int k = 0; k < 3; ++k) {
        const Vec3& p = mesh.positions[t[k]];
        uvs[k] = {mirrored ? 0.5 - 0.9 * p[0] : 0.5 + 0.9 * p[0], 0.5 + 0.9 * p[1]};
      }
    }
    const Surface surface(mesh, {.kind = AtlasKind::uv, .resolution = 64});
    const MeshAttribute found = tangents(surface, smooth_normals(mesh));
    EXPECT_EQ(found.values.size(), 4U * 4U);  // a row for each vertex
    for (std::size_t i = 0; i < found.values.size(); i += 4) {
      EXPECT_NEAR(found.values[i], mirrored ? -1 : 1, 1e-6);
      EXPECT_NEAR(found.values[i + 1], 0, 1e-6);
      EXPECT_NEAR(found.values[i + 2], 0, 1e-6);
      // The bitangent w · cross(n, t) is +y, up in the image.
      EXPECT_EQ(found.values[i + 3], mirrored ? -1 : 1);
    }
  }
}

// A flat part, drawn flat: no detail is (0, 0, 1), whatever the charts.
TEST(BakedGeometry, NormalsOfTheSurfaceItselfAreStraightUp) {
  if (!has_tangents()) GTEST_SKIP() << "without MikkTSpace";
  const Surface surface(cube(), {.resolution = 64});
  const Sites sites(cube());
  const MeshAttribute flat = smooth_normals(cube(), 30);
  const TexelMatches matches = match_texels(surface, sites);
  const auto coordinates = tangent_space_normals(surface, flat, tangents(surface, flat),
                                                 matched_normals(surface, sites, matches, flat));
  for (const std::uint32_t texel : test::owned_texels(surface))
    ASSERT_NEAR(norm(vector_at(coordinates, texel) - Vec3{0, 0, 1}), 0, 1e-6) << texel;
}

TEST(BakedGeometry, DisplacementsLeadAlongTheNormalToTheMatch) {
  const Mesh low = sphere(2), high = bumpy(4);
  const Surface surface(low, {.resolution = 96});
  const Sites sites(high);
  const MeshAttribute normals = smooth_normals(low);
  const TexelMatches matches =
      match_texels(surface, sites, {.method = MatchMethod::ray, .normals = &normals});
  ASSERT_EQ(matches.count(MatchKind::ray), surface.owned_texels());
  const auto displacements = matched_displacements(surface, sites, matches, normals);
  const auto positions = matched_positions(surface, sites, matches);
  // The normals of the surface itself, where no displacement is: transferred to its own texels.
  const Sites itself(low);
  const auto directions = matched_normals(surface, itself, match_texels(surface, itself), normals);
  std::size_t below = 0;
  for (const std::uint32_t texel : test::owned_texels(surface)) {
    below += displacements[texel] < 0;
    const Vec3 end =
        surface.texel_point(texel) + static_cast<double>(displacements[texel]) * vector_at(directions, texel);
    ASSERT_NEAR(norm(end - vector_at(positions, texel)), 0, 1e-5) << texel;
    ASSERT_NEAR(norm(point_of_match(high, matches.point(texel)) - vector_at(positions, texel)), 0, 1e-6);
  }
  EXPECT_GT(below, 100U);
  EXPECT_LT(below, surface.owned_texels());
}

TEST(BakedGeometry, NormalsOfAClosedMeshAreOutwardHoweverItIsWound) {
  const Surface surface(sphere(2), {.resolution = 48});
  const Sites inside_out(flipped(sphere(2)));
  const TexelMatches matches = match_texels(surface, inside_out);
  ASSERT_EQ(matches.count(MatchKind::facing), surface.owned_texels());
  for (const bool by_file : {false, true}) {
    // Of a file, normals may be outward although the faces are not.
    const MeshAttribute normals = by_file ? smooth_normals(sphere(2)) : smooth_normals(inside_out.mesh());
    const auto found = matched_normals(surface, inside_out, matches, normals);
    for (const std::uint32_t texel : test::owned_texels(surface))
      ASSERT_GT(dot(vector_at(found, texel), surface.texel_point(texel)), 0.9);
  }
}

TEST(BakedGeometry, OcclusionAndThicknessAreThoseOfTheMatchedPoint) {
  // The floor of a corner of two squares sees half of the sky at its edge, and all of it far away.
  Mesh corner = square(2, 0);
  Mesh wall = square(2, 0);
  for (Vec3& p : wall.positions) p = {-1, p[1], p[0] + 1};
  corner = joined(corner, wall);
  const Surface floor(square(1.9, 0.01), {.resolution = 64});
  const Sites sites(corner);
  const TexelMatches matches = match_texels(floor, sites);
  const auto visible = matched_occlusion(floor, sites, matches, {.rays = 256});
  double near = 0, far = 0;
  std::size_t of_near = 0, of_far = 0;
  for (const std::uint32_t texel : test::owned_texels(floor)) {
    ASSERT_FALSE(std::isnan(visible[texel]));
    const Vec3 p = floor.texel_point(texel);
    if (std::abs(p[1]) > 0.3) continue;
    if (p[0] < -0.9) {
      near += visible[texel];
      ++of_near;
    }
    if (p[0] > 0.8) {
      far += visible[texel];
      ++of_far;
    }
  }
  ASSERT_GT(of_near, 0U);
  ASSERT_GT(of_far, 0U);
  EXPECT_NEAR(near / static_cast<double>(of_near), 0.5, 0.06);
  EXPECT_GT(far / static_cast<double>(of_far), 0.9);

  Mesh plate = cube();
  for (Vec3& p : plate.positions) p[2] *= 0.05;
  const Surface above(square(1, 0.2), {.resolution = 16});
  const Sites solid(plate);
  for (const ThicknessMethod method : {ThicknessMethod::ball, ThicknessMethod::ray}) {
    const auto thickness = matched_thickness(above, solid, match_texels(above, solid), method);
    for (const std::uint32_t texel : test::owned_texels(above)) ASSERT_NEAR(thickness[texel], 0.1, 1e-6);
  }
  EXPECT_NE(error_of([&] { (void)matched_occlusion(floor, sites, matches, {.rays = 0}); }), "");
  EXPECT_NE(error_of([&] { (void)matched_thickness(floor, sites, matches, ThicknessMethod::ray); }), "");
}

TEST(BakedGeometry, FreeTexelsAreFilledAndUnmatchedOnesAreNot) {
  const Surface surface(sphere(1), {.resolution = 64});
  const Sites sites(moved(sphere(3), {0.5, 0, 0}));
  const TexelMatches matches = match_texels(surface, sites, {.max_distance = 0.3});
  ASSERT_GT(matches.count(MatchKind::too_far), 10U);
  auto values = matched_positions(surface, sites, matches);
  fill_texels(surface, 3, values);
  for (std::uint32_t i = 0; i < matches.kind.size(); ++i)
    ASSERT_EQ(std::isnan(values[3 * i]), matches.kind[i] == MatchKind::too_far) << i;
  EXPECT_NE(error_of([&] { fill_texels(surface, 4, values); }), "");
}

TEST(BakedGeometry, RefusesWhatDoesNotFit) {
  const Surface surface(cube(), {.resolution = 16}), other(cube(), {.resolution = 32});
  const Sites sites(sphere(1));
  const TexelMatches matches = match_texels(surface, sites);
  const MeshAttribute of_cube = smooth_normals(cube()), of_sphere = smooth_normals(sphere(1));
  EXPECT_NE(error_of([&] { (void)matched_normals(surface, sites, matches, of_cube); }), "");
  EXPECT_NE(error_of([&] { (void)matched_normals(other, sites, matches, of_sphere); }), "");
  EXPECT_NE(error_of([&] { (void)matched_displacements(surface, sites, matches, of_sphere); }), "");
  const std::vector<float> few(12);
  EXPECT_NE(error_of([&] { (void)tangent_space_normals(surface, of_cube, of_cube, few); }), "");
}

// As of a file in which some parts have no normals.
TEST(BakedGeometry, NormalsThatAreNotFiniteAreThoseOfFaces) {
  const Surface surface(cube(), {.resolution = 16});
  const Sites sites(cube(2));
  const TexelMatches matches = match_texels(surface, sites);
  MeshAttribute none = smooth_normals(cube(2)), flat = smooth_normals(cube(2), 1);
  std::ranges::fill(none.values, std::numeric_limits<float>::quiet_NaN());
  const std::vector<float> normals = matched_normals(surface, sites, matches, none);
  const std::vector<float> expected = matched_normals(surface, sites, matches, flat);
  for (std::size_t i = 0; i < normals.size(); ++i)
    if (std::isnan(expected[i]))
      EXPECT_TRUE(std::isnan(normals[i]));
    else
      EXPECT_NEAR(normals[i], expected[i], 1e-6);
}

}  // namespace
}  // namespace sdm::test
