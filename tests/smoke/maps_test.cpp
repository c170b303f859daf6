// Maps of every kind: one small case for each, against brute force or a closed form.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/gl.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "smoke/small_meshes.h"
#include "support/made_up_maps.h"
#include "support/map_checks.h"
#include "support/oracle.h"
#include "support/shapes.h"
#include "support/thickness.h"

namespace sdm::test {
namespace {

std::vector<double> distances_of_samples(const Surface& surface, const Mesh& o2) {
  std::vector<double> distances;
  for (const Vec3& p : surface.sample_points()) distances.push_back(oracle::brute_force(o2, p));
  return distances;
}

/// Names of engines; those on OpenGL and WebGPU where there is a device for them.
std::vector<std::string> engines_here() {
  std::vector<std::string> names;
  for (const EngineInfo& info : engines()) {
    try {
      if (info.name == "gl") (void)gl_devices();
      if (info.name == "gpu") (void)make_engine(info.name);
      names.emplace_back(info.name);
    } catch (const Error&) {
      continue;
    }
  }
  return names;
}

TEST(SmokeMaps, EveryEngineOnEveryAtlasAgreesWithBruteForce) {
  const Mesh o1 = torus(9, 7), o2 = moved(sphere(1), {1.5, 0.2, 0.1});
  const Sites sites(o2);
  for (const AtlasKind kind : {AtlasKind::charts, AtlasKind::triangles, AtlasKind::uv}) {
    const Surface surface(o1, {.kind = kind, .resolution = 61});
    EXPECT_EQ(surface.atlas_kind(), kind);
    const std::vector<double> expected = distances_of_samples(surface, o2);
    for (const std::string& name : engines_here()) {
      SCOPED_TRACE(name);
      const std::shared_ptr<const Engine> engine = make_engine(name);
      const DistanceMap map = compute_map(surface, sites, {.engine = engine});
      const double accuracy = engine_accuracy(engine_info(*engine), o1, o2);
      EXPECT_EQ(map.sign.method, SignMethod::exact);
      expect_map(surface, sites, map, expected, accuracy + 1e-6);
      for (std::size_t i = 0; i < expected.size(); ++i) {
        const std::uint32_t t = surface.sample_texels()[i];
        if (expected[i] > 1e-4) {
          EXPECT_EQ(map.distance[t] < 0, oracle::winding_number(o2, surface.texel_point(t)) != 0);
        }
      }
      const DistanceMap near = compute_map(surface, sites, {.engine = engine, .max_distance = 0.4});
      std::size_t beyond = 0;
      for (std::size_t i = 0; i < expected.size(); ++i)
        beyond += std::isnan(near.distance[surface.sample_texels()[i]]);
      EXPECT_EQ(near.beyond_max_distance, beyond);
      EXPECT_NEAR(static_cast<double>(beyond),
                  static_cast<double>(std::ranges::count_if(expected, [](double d) { return d > 0.4; })), 2);
      if (gl_report(*engine)) {
        EXPECT_EQ(gl_report(*engine)->unconfirmed, 0u);
      }
    }
  }
}

TEST(SmokeMaps, ClippingByAStencilDrawsTheSameMap) {
  const std::vector<std::string> names = engines_here();
  if (std::ranges::find(names, "gl") == names.end()) GTEST_SKIP() << "without a device";
  const Surface surface(sphere(1), {.resolution = 45});
  const Sites sites(torus(5, 7));
  const auto engine = make_gl_engine({.clip = GlClip::stencil, .stencil_values = 3});
  const DistanceMap map = compute_map(surface, sites, {.engine = engine});
  expect_map(surface, sites, map, distances_of_samples(surface, sites.mesh()), 1e-5);
  EXPECT_EQ(gl_report(*engine)->unconfirmed, 0u);
  const auto report = gl_report(*engine).value();
  EXPECT_GT(std::ranges::find(report.counts, "stencil_evictions",
                              &std::pair<std::string_view, std::uint64_t>::first)
                ->second,
            0u);
  EXPECT_FALSE(gl_device(45).name.empty());
}

TEST(SmokeMaps, OfAwkwardMeshesAgreeWithBruteForce) {
  const std::vector<Mesh> meshes = awkward_meshes();
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const Mesh& o2 = meshes[i];
    Mesh o1 = meshes[(i + 3) % meshes.size()];
    const Vec3 to = bounds(o2).lower, from = bounds(o1).lower;
    const double scale = scene_diagonal(o2, o2) / scene_diagonal(o1, o1);
    o1 = mapped_by(o1, [&](const Vec3& p) { return to + scale * (p - from); });
    for (const AtlasKind kind : {AtlasKind::charts, AtlasKind::triangles}) {
      const Surface surface(o1, {.kind = kind, .resolution = 47, .gutter = 0});
      const Sites sites(o2);
      const double size = scene_diagonal(o1, o2);
      expect_map(surface, sites, compute_map(surface, sites, {.sign = SignMethod::none}),
                 distances_of_samples(surface, o2), 1e-6 * size + 1e-7 * norm(to));
    }
  }
}

TEST(SmokeMaps, PartsOfAMapMakeTheWhole) {
  const Surface surface(torus(16, 9), {.resolution = 129});
  const Sites sites(moved(torus(11, 9), {0.3, 0.1, 0.2}));
  const DistanceMap expected = compute_map(surface, sites);
  DistanceMap map = empty_map(surface);
  const std::size_t grain = sample_range_grain(surface), count = surface.sample_texels().size();
  ASSERT_GT(count, 2 * grain);
  std::vector<std::size_t> firsts;
  for (std::size_t first = 0; first < count; first += grain) firsts.push_back(first);
  std::ranges::reverse(firsts);
  for (const std::size_t first : firsts)
    compute_samples(surface, sites, {}, {.first = first, .count = std::min(grain, count - first)}, map);
  for (const std::uint32_t t : surface.sample_texels()) {
    EXPECT_EQ(map.distance[t], expected.distance[t]);
    EXPECT_EQ(map.site[t], expected.site[t]);
  }
  DistanceMap again;
  compute_map(surface, sites, {.engine = make_engine("reference")}, again);
  for (const std::uint32_t t : surface.sample_texels())
    EXPECT_NEAR(again.distance[t], expected.distance[t], 1e-5);
}

// The other skin of a thin plate is nearer, but faces the other way.
TEST(SmokeMaps, FacingDistancesOfAPlateAreToTheSkinThatFacesAsTheSample) {
  const Mesh plate = grid_block({-1, -1, 0}, {1, 1, 0.1}, 3),
             dented = grid_block({-0.7, -0.7, 0}, {0.7, 0.7, 0.02}, 3);
  const Surface surface(dented, {.resolution = 63});
  const Sites sites(weld(plate).mesh);
  const DistanceMap map = compute_map(surface, sites, {.facing = 45});
  EXPECT_EQ(map.measured.kind, DistanceKind::facing);
  EXPECT_EQ(measured_distance(MapOptions{.facing = 45}).kind, DistanceKind::facing);
  for (const std::uint32_t t : surface.sample_texels()) {
    const Vec3 p = surface.texel_point(t);
    const Triangle corners = dented.triangles[surface.map_faces()[t]];
    const Vec3 n = cross(dented.positions[corners[1]] - dented.positions[corners[0]],
                         dented.positions[corners[2]] - dented.positions[corners[0]]);
    const double side = 1 - std::max(std::abs(p[0]), std::abs(p[1]));
    EXPECT_NEAR(std::abs(map.distance[t]), n[2] > 1e-9 ? 0.1 - p[2] : n[2] < -1e-9 ? p[2] : side, 1e-5);
  }
  EXPECT_EQ(map.without_match, 0u);
  const DistanceMap none =
      compute_map(Surface(square(1, 0), {.resolution = 16}), Sites(flipped(square(3, 1))), {.facing = 10});
  EXPECT_GT(none.without_match, 0u);
  const std::vector<float> at_corners = distances_at_vertices(dented, sites, {.facing = 45});
  for (const float d : at_corners) EXPECT_LT(std::abs(d), 0.31);
}

TEST(SmokeMaps, DistancesAlongTheVerticalAreChangesOfHeight) {
  const auto raised = [](const Vec3& p) { return p + Vec3{0, 0, 0.3 - 0.2 * p[0] + 0.1 * p[1]}; };
  const Mesh before = mapped_by(grid_square(3, 0, 7), [](const Vec3&p) { return 2 * p; }),
             after = mapped_by(grid_square(2, 0, 5), raised);
  const Surface surface(after, {.resolution = 53});
  const Sites sites(before);
  const AlongOptions down{.direction = Vec3{0, 0, -2}};
  const DistanceMap map = compute_map(surface, sites, down);
  EXPECT_EQ(map.measured.kind, DistanceKind::along);
  EXPECT_EQ(measured_distance(down).kind, DistanceKind::along);
  for (const std::uint32_t t : surface.sample_texels())
    EXPECT_NEAR(map.distance[t], surface.texel_point(t)[2], 1e-6);
  const std::vector<float> at_vertices = distances_at_vertices(after, sites, down);
  for (std::size_t v = 0; v < after.positions.size(); ++v)
    EXPECT_NEAR(at_vertices[v], after.positions[v][2], 1e-6);
  // Along normals the lines are those of the plane, and longer by 1 / n_z.
  const Vec3 n = normalized(Vec3{0.2, -0.1, 1});
  const DistanceMap normals = compute_map(surface, sites, AlongOptions{.max_distance = 0.4});
  std::size_t beyond = 0;
  for (const std::uint32_t t : surface.sample_texels()) {
    const double expected = surface.texel_point(t)[2] / n[2];
    if (std::abs(expected) > 0.4 - 1e-5) {
      ++beyond;
    } else {
      EXPECT_NEAR(normals.distance[t], expected, 1e-6);
    }
  }
  EXPECT_GT(normals.beyond_max_distance, 0u);
  EXPECT_LE(normals.beyond_max_distance, beyond);
  const std::vector<Vec3> points{{0.1, 0.2, 0.7}, {0.3, -0.1, -0.4}, {9, 9, 0}}, up(3, {0, 0, 3});
  const FacingPoints hits = closest_points_along(sites, points, up, {});
  EXPECT_NEAR(hits.closest[0].distance, 0.7, 1e-12);
  EXPECT_NEAR(hits.closest[1].distance, 0.4, 1e-12);
  EXPECT_EQ(hits.behind[0], 0);
  EXPECT_EQ(hits.behind[1], 1);
  EXPECT_EQ(hits.unmatched[2], 1);
}

TEST(SmokeMaps, OfAMeshToItselfLeaveOutTheNeighbourhood) {
  // Two squares that face each other, 0.3 apart.
  const Mesh mesh = joined(grid_square(1, 0, 4), grid_square(1, 0.3, 4));
  const Surface surface(mesh, {.resolution = 61});
  const Sites sites(mesh);
  for (const ExclusionRule& rule : {ExclusionRule{.rings = 9}, ExclusionRule{.geodesic = 0.2}}) {
    const Exclusion exclusion(mesh, {.rule = rule});
    EXPECT_EQ(exclusion.faces(), 64u);
    EXPECT_TRUE(exclusion.excludes(0, 1));
    EXPECT_FALSE(exclusion.excludes(0, 40));
    std::size_t faces = 0;
    for (std::uint32_t p = 0; p < exclusion.patches(); ++p) {
      faces += exclusion.faces_of(p).size();
      EXPECT_TRUE(std::ranges::binary_search(exclusion.excluded_by(p), p));
      EXPECT_EQ(exclusion.patch_of(exclusion.faces_of(p)[0]), p);
    }
    EXPECT_EQ(faces, 64u);
    const DistanceMap map =
        compute_map(surface, sites, SelfOptions{.exclusion = exclusion, .max_distance = 0.9});
    for (const std::uint32_t t : surface.sample_texels()) EXPECT_LT(map.distance[t], 0.3 + 1e-6);
    const std::vector<float> corners =
        distances_at_vertices(sites.mesh(), sites, SelfOptions{.exclusion = exclusion});
    ASSERT_EQ(corners.size(), mesh.positions.size());
    for (const float d : corners) EXPECT_LT(d, 0.3 + 1e-6);
    if (!rule.geodesic) {
      for (const std::uint32_t t : surface.sample_texels()) EXPECT_NEAR(map.distance[t], 0.3, 1e-6);
      EXPECT_NEAR(summarize_self(surface, map).distance.max, 0.3, 1e-6);
    }
  }
}

TEST(SmokeMaps, ThicknessOfAPlateIsItsHeight) {
  const Mesh plate = weld(grid_block({-3, -2, 0}, {3, 2, 0.25}, 5)).mesh;
  const Surface surface(plate, {.resolution = 91});
  const Sites sites(plate);
  const ThicknessMaps maps = thickness_maps(surface, sites);
  std::size_t inner = 0;
  for (const std::uint32_t t : surface.sample_texels()) {
    const Vec3 p = surface.texel_point(t);
    const bool level = p[2] < 1e-9 || p[2] > 0.25 - 1e-9;
    if (!level) continue;
    ++inner;
    EXPECT_NEAR(maps.ray.distance[t], 0.25, 1e-6);
    EXPECT_NEAR(maps.ball.distance[t], 0.25, 1e-6) << "sides do not stop balls at 90°";
  }
  EXPECT_GT(inner, 500u);
  for (const ThicknessMethod method : {ThicknessMethod::ball, ThicknessMethod::ray})
    EXPECT_NEAR(
        std::ranges::min(distances_at_vertices(sites.mesh(), sites, ThicknessOptions{.method = method})),
        0.25, 1e-5);
  EXPECT_NEAR(estimate_walls(sites, 0.3, 301)->thin, 48.0 / 53, 0.05);
  const std::vector<std::uint32_t> thin = thinnest_texels(surface, maps.ray, 3),
                                   thick = thickest_texels(surface, maps.ray, 3);
  ASSERT_EQ(thin.size(), 3u);
  EXPECT_NEAR(maps.ray.distance[thin[0]], 0.25, 1e-6);
  EXPECT_NEAR(maps.ray.distance[thick[0]], 6, 1e-5);
  EXPECT_LT(thickness_accuracy(plate), 1e-6);
  const Summary summary = summarize_thickness(surface, maps.ray, {.tolerance = Tolerance(0.2, 9)});
  EXPECT_EQ(summary.tolerance->verdict, Verdict::pass);
  EXPECT_FALSE(summary.tolerance->certified);

  // Balls and rays of a part of two shells, of which one is a cavity.
  const Mesh shell = joined(sphere(2), flipped(mapped_by(sphere(2), [](const Vec3& p) { return 0.8 * p; })));
  const Surface skin(shell, {.resolution = 64});
  const ThicknessMaps of_shell = thickness_maps(skin, Sites(shell), 60);
  for (const std::uint32_t t : skin.sample_texels()) {
    EXPECT_NEAR(of_shell.ray.distance[t], 0.2, 0.06);
    EXPECT_LE(of_shell.ball.distance[t], of_shell.ray.distance[t] + 1e-6);
  }
}

TEST(SmokeMaps, SignsOfOpenMeshesAreTheirSides) {
  const Surface surface(mapped_by(grid_square(1, 0, 3),
                                  [](const Vec3& p) {
                                    return p + Vec3{0, 0, p[0]};
                                  }),
                        {.resolution = 31});
  const Sites sites(grid_square(2, 0, 3));
  const DistanceMap map = compute_map(surface, sites, {.sign = SignMethod::side});
  for (const std::uint32_t t : surface.sample_texels())
    EXPECT_NEAR(map.distance[t], surface.texel_point(t)[2], 1e-6);
  EXPECT_EQ(map.sign.method, SignMethod::side);
  EXPECT_TRUE(is_estimate(map.sign.method));
  EXPECT_EQ(choose_sign(sites, MapOptions{}).method, SignMethod::none);

  const Mesh lidless = first_faces(cube(), 10);
  const Sites open(lidless);
  const Surface ball(mapped_by(sphere(1), [](const Vec3& p) { return 0.3 * p; }), {.resolution = 31});
  const DistanceMap winding = compute_map(ball, open, {.sign = SignMethod::winding});
  for (const std::uint32_t t : ball.sample_texels())
    EXPECT_NEAR(winding.distance[t], -oracle::brute_force(lidless, ball.texel_point(t)), 1e-5);
}

TEST(SmokeMaps, BoundaryMasksMarkWhatIsBesideAnOpenMesh) {
  const Mesh wide = grid_square(3, 0.1, 6);
  const Surface surface(wide, {.resolution = 47});
  const Sites sites(grid_square(1, 0, 3));
  const DistanceMap map = compute_map(surface, sites);
  const std::vector<std::uint8_t> mask = boundary_mask(sites, map);
  for (const std::uint32_t t : surface.sample_texels()) {
    const Vec3 p = surface.texel_point(t);
    const double beside = std::max(std::abs(p[0]), std::abs(p[1])) - 0.5;
    if (std::abs(beside) > 1e-6) {
      EXPECT_EQ(mask[t] != 0, beside > 0);
    }
  }
  const std::vector<std::uint8_t> vertices = boundary_vertices(wide, sites);
  const std::vector<float> distances = distances_at_vertices(wide, sites, {.max_distance = 1});
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const Vec3& p = wide.positions[v];
    const double x = std::max(0.0, std::abs(p[0]) - 0.5), y = std::max(0.0, std::abs(p[1]) - 0.5),
                 d = std::sqrt(x * x + y * y + 0.01);
    if (x > 0 || y > 0) {
      EXPECT_EQ(vertices[v], 1);
    }
    if (d > 1) {
      EXPECT_TRUE(std::isnan(distances[v]));
    } else {
      EXPECT_NEAR(distances[v], d, 1e-6);
    }
  }
}

// Half of the faces in tile 1001, half in 1012, and one face across a border of a texture that repeats.
TEST(SmokeMaps, UdimTilesAreMapsOfTheirOwn) {
  Mesh mesh = grid_square(1, 0, 4);
  for (std::size_t f = 16; f < 32; ++f)
    for (Vec2& uv : mesh.corner_uvs[f]) uv = uv + Vec2{1, 1};
  const UvTiles tiles = uv_tiles(mesh);
  ASSERT_EQ(tiles.tiles.size(), 2u);
  EXPECT_TRUE(tiles.is_udim());
  EXPECT_FALSE(tiles.is_unit_square());
  EXPECT_EQ(tiles.tiles[1].udim(), 1012);
  EXPECT_FALSE(has_one_uv(mesh));
  const Sites sites(grid_square(3, 0.25, 2));
  CombinedStatistics combined;
  CombinedSummary summaries;
  for (const UvTile& tile : tiles.tiles) {
    const Mesh part = uv_tile_mesh(mesh, tile);
    const Surface surface(part, {.kind = AtlasKind::uv, .resolution = 33});
    const DistanceMap map = compute_map(surface, sites);
    for (const std::uint32_t t : surface.sample_texels()) EXPECT_NEAR(map.distance[t], 0.25, 1e-6);
    combined.add(surface, map);
    summaries.add(
        surface, map,
        summarize(surface, sites, map, distances_at_vertices(part, sites), {.tolerance = Tolerance(0.3)}));
  }
  EXPECT_NEAR(combined.statistics().mean, 0.25, 1e-6);
  EXPECT_EQ(summaries.summary().tolerance->verdict, Verdict::pass);
  EXPECT_NEAR(summaries.summary().distance.max, 0.25, 1e-6);

  Mesh repeated = grid_square(1, 0, 3);
  for (auto& corners : repeated.corner_uvs)
    for (Vec2& uv : corners) uv = Vec2{2.4 * uv[0] - 0.3, 1.7 * uv[1]};
  const UvTiles crossed = uv_tiles(repeated);
  EXPECT_FALSE(crossed.crossing.empty());
  const WrappedUvs wrapped = wrap_uvs(repeated, crossed);
  EXPECT_EQ(wrapped.cut_faces, crossed.crossing.size());
  EXPECT_NEAR(inspect(wrapped.mesh).area, 1, 1e-12);
  EXPECT_TRUE(uv_tiles(wrapped.mesh).is_unit_square());
  EXPECT_EQ(wrapped.source_face.size(), wrapped.mesh.triangles.size());
  const Surface whole(wrapped.mesh, {.kind = AtlasKind::uv, .resolution = 40, .rows = 24});
  EXPECT_EQ(whole.rows(), 24u);
  EXPECT_GT(whole.overlapping_texels(), 0u);
  for (const float d : compute_map(whole, sites).distance)
    if (!std::isnan(d)) {
      EXPECT_NEAR(d, 0.25, 1e-6);
    }
}

TEST(SmokeMaps, ChannelsHaveWhatTheMapHas) {
  const Mesh o1 = sphere(1);
  const Surface surface(o1, {.resolution = 37});
  const Sites sites(first_faces(torus(7, 5), 61));
  const DistanceMap map = compute_map(surface, sites, {.max_distance = 1.2});
  const std::vector<std::uint8_t> boundary = boundary_mask(sites, map);
  std::vector<std::uint32_t> texels(surface.sample_texels().begin(), surface.sample_texels().end());
  texels.push_back(kNone);
  const auto values = read_channels(channels(), {&map, &surface, &sites, boundary}, texels);
  ASSERT_EQ(values.size(), channels().size());
  std::size_t compared = 0;
  for (std::size_t c = 0; c < values.size(); ++c) {
    const Channel& channel = channels()[c];
    const std::size_t size = channel.components() * size_of(channel.type);
    EXPECT_EQ(values[c].size(), size * texels.size()) << channel.name << ' ' << name_of(channel.type);
    for (std::size_t i = 0; i + 1 < texels.size(); ++i) {
      const std::byte* const at = &values[c][i * size];
      if (std::string(channel.name) == "distance") {
        EXPECT_EQ(std::memcmp(at, &map.distance[texels[i]], 4), 0);
        ++compared;
      } else if (std::string(channel.name) == "site") {
        EXPECT_EQ(std::memcmp(at, &map.site[texels[i]], 4), 0);
        ++compared;
      } else if (std::string(channel.name) == "vector") {
        EXPECT_EQ(std::memcmp(at, &map.vector[texels[i]], 12), 0);
        ++compared;
      }
    }
  }
  EXPECT_EQ(compared, 3 * (texels.size() - 1));
  EXPECT_LE(default_channel_layers().size(), channel_layers().size());
}

TEST(SmokeMaps, OfDeformedAndEditedMeshesAreThoseOfNewOnes) {
  const Mesh first = sphere(1), to = torus(9, 5);
  Surface surface(first, {.kind = AtlasKind::triangles, .resolution = 61});
  Sites sites(to);
  SamplingBound bound(surface);
  const double before = bound.value(), allowed = bound.value_after(0.5);
  const RelativeError error(surface, bound);
  const Mesh second = mapped_by(first,
                                [](const Vec3&p) {
                                  return Vec3{2 * p[0], 2 * p[1], 2 * p[2]};
                                }),
             moved_to = mapped_by(to, [](const Vec3&p) {
               return Vec3{p[1], p[2] + 0.1, p[0]};
             });
  surface.refit(second.positions);
  sites.refit(moved_to.positions);
  bound.refit(surface);
  EXPECT_NEAR(bound.value(), 2 * before, 1e-6);
  EXPECT_NEAR(allowed, before + 1, 1e-6);
  EXPECT_GE(error.of(bound), 2 - 1e-6);
  EXPECT_LT(error.of(bound), 2.6);
  EXPECT_EQ(error.of_edited(bound), error.of(bound));
  std::vector<double> of_faces(first.triangles.size());
  error.of_faces(bound, of_faces);
  EXPECT_GE(std::ranges::min(of_faces), 2 - 1e-6);
  expect_map(surface, sites, compute_map(surface, sites), distances_of_samples(surface, moved_to), 2e-5);

  const MeshEdit edit{
      .removed_faces = {0, 7},
      .reconnected_faces = {{.face = 3, .triangle = {42, second.triangles[3][1], second.triangles[3][2]}}},
      .moved_vertices = {{.vertex = 5, .position = {2.2, 0.3, 0.1}}},
      .added_vertices = {second.positions[second.triangles[3][0]] + Vec3{0.1, 0, 0}, {3, 3, 0}, {3, 2, 0}},
      .added_faces = {{42, 43, 44}, {0, 44, 43}}};
  surface.edit(edit);
  Mesh edited = second;
  apply(edited, edit);
  EXPECT_EQ(surface.mesh().positions, edited.positions);
  const MeshEdit torn{
      .removed_faces = {11, 12, 13}, .added_vertices = {{0, 0, 3}}, .added_faces = {{0, 1, 45}}};
  sites.edit(torn);
  Mesh torn_mesh = moved_to;
  apply(torn_mesh, torn);
  const Sites expected(torn_mesh);
  EXPECT_TRUE(std::ranges::equal(sites.edges(), expected.edges()));
  EXPECT_EQ(sites.closed(), expected.closed());
  expect_map(surface, sites, compute_map(surface, sites), distances_of_samples(surface, torn_mesh), 2e-5);
  EXPECT_GT(SamplingBound(surface).value(), 0);
}

TEST(SmokeMaps, EveryPointHasASampleWithinTheBound) {
  for (const Mesh& mesh : {torus(9, 7), single_triangle(), needles(0.01), degenerate_soup(33, 4)}) {
    const Surface surface(mesh, {.resolution = 71});
    const SamplingBound bound(surface);
    const double size = scene_diagonal(mesh, mesh);
    EXPECT_NEAR(covering_radius(surface), bound.value(), 1e-5 * size);
    const std::vector<Vec3> samples = surface.sample_points();
    std::mt19937 random(3);
    for (const Vec3& p : random_surface_points(mesh, 150, random)) {
      bool covered = false;
      for (std::size_t i = 0; i < samples.size() && !covered; ++i)
        covered = norm(p - samples[i]) <= bound.sample_radii()[i] + 1e-9 * size;
      EXPECT_TRUE(covered);
    }
    EXPECT_GE(std::ranges::max(bound.face_radii()) + 1e-9 * size, 0);
  }
  const std::uint32_t resolution = resolution_for(torus(9, 7), 0.1);
  EXPECT_LE(covering_radius(Surface(torus(9, 7), {.resolution = resolution})), 0.1);
  EXPECT_GT(covering_radius(Surface(torus(9, 7), {.resolution = resolution / 2})), 0.1);
}

TEST(SmokeMaps, StoredAtlasesAreThoseOfTheirSurface) {
  for (const AtlasKind kind : {AtlasKind::charts, AtlasKind::triangles, AtlasKind::uv}) {
    const Mesh mesh = torus(7, 5);
    const AtlasOptions options{.kind = kind, .resolution = 50, .gutter = 2};
    const Surface surface(mesh, options), same(mesh, options, surface.stored_atlas());
    EXPECT_TRUE(std::ranges::equal(surface.texel_faces(), same.texel_faces()));
    EXPECT_TRUE(std::ranges::equal(surface.sample_texels(), same.sample_texels()));
    EXPECT_EQ(surface.sample_points(), same.sample_points());
    EXPECT_EQ(surface.chart_count(), same.chart_count());
    EXPECT_TRUE(std::ranges::equal(surface.face_charts(), same.face_charts()));
    EXPECT_EQ(same.gutter(), 2u);
    EXPECT_GT(same.utilisation(), 0.05);
    EXPECT_GE(same.max_stretch(), 1);
    for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
      const std::array<Vec2, 3> corners = same.atlas_corners(f);
      const auto edges = same.texel_edges(f);
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3& corner = mesh.positions[mesh.triangles[f][k]];
        const Vec2 to = same.to_atlas(f, corner);
        EXPECT_NEAR(to[0], corners[k][0], 1e-6);
        EXPECT_LT(norm(same.to_surface(f, corners[k]) - corner), 1e-6);
        const Vec3 stepped = same.to_surface(f, corners[k] + Vec2{1, 0});
        EXPECT_LT(norm(stepped - corner - edges[0]), 1e-6);
      }
    }
  }
}

// A mesh as rough as a scan, whose charts follow the smoothed surface.
TEST(SmokeMaps, ChartsOfRoughMeshesKeepEveryFace) {
  Mesh mesh = grid_square(2, 0, 40);
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 0.05);
  for (Vec3& p : mesh.positions) p[2] += noise(random);
  const Surface surface(mesh, {.resolution = 256});
  std::vector<std::size_t> texels(mesh.triangles.size());
  for (const std::uint32_t f : surface.texel_faces())
    if (f != kNone) ++texels[f];
  EXPECT_LT(std::ranges::count(texels, 0u), 100);
  const Sites sites(grid_square(9, 0, 2));
  const DistanceMap map = compute_map(surface, sites);
  for (const std::uint32_t t : surface.sample_texels())
    EXPECT_NEAR(map.distance[t], std::abs(surface.texel_point(t)[2]), 1e-5);
}

TEST(SmokeMaps, TemporalMapsHaveLeastLargestAndMean) {
  Surface surface(grid_square(1, 0, 3), {.resolution = 40});
  TemporalMaps temporal;
  const std::vector<double> heights{0.5, -0.25, 1};
  for (std::size_t i = 0; i < 3; ++i) {
    if (i == 2) temporal = TemporalMaps(TemporalMaps::State(temporal.state()));
    temporal.add(map_of(surface, [&](const Vec3& p) { return p[0] * heights[i]; }));
  }
  EXPECT_EQ(temporal.maps(), 3u);
  EXPECT_EQ(temporal.resolution(), 40u);
  const std::vector<float> mean = temporal.mean();
  for (const std::uint32_t t : surface.sample_texels()) {
    const double x = surface.texel_point(t)[0];
    EXPECT_NEAR(temporal.least()[t], std::min(-0.25 * x, x), 1e-6);
    EXPECT_NEAR(temporal.largest()[t], std::max(-0.25 * x, x), 1e-6);
    EXPECT_NEAR(mean[t], 1.25 / 3 * x, 1e-6);
  }
  const std::vector<std::uint32_t> before(surface.texel_faces().begin(), surface.texel_faces().end());
  surface.edit(
      {.removed_faces = {4}, .added_faces = {{0, 5, 9}}, .added_corner_uvs = {{{{0, 0}, {1, 0}, {0, 1}}}}});
  temporal.follow_edit(before, surface);
  for (std::size_t t = 0; t < before.size(); ++t)
    if (before[t] == 4) {
      EXPECT_TRUE(std::isnan(temporal.mean()[t]));
    }
}

TEST(SmokeMaps, CoverageIsTheShareOfTheAreaWithinReach) {
  const Mesh o2 = joined(grid_square(1, 0, 2), moved(grid_square(1, 0, 3), {5, 0, 0}));
  const Mesh measured = grid_square(1, 0.01, 4);
  for (const Coverage& found :
       {coverage(o2, Sites(measured), 0.05), Coverage(coverage_map(o2, Sites(measured), 0.05))}) {
    EXPECT_NEAR(found.value, 0.5, 0.002);
    EXPECT_LE(found.lower, 0.5 + 1e-9);
    EXPECT_GE(found.upper, 0.5 - 1e-9);
  }
  // Points on one half of one of the squares.
  std::vector<Vec3> points;
  for (int i = 0; i < 37; ++i)
    for (int j = 0; j < 73; ++j) points.push_back({-0.5 + i / 72.0, -0.5 + j / 72.0, 0});
  const CoverageMap map = coverage_map(o2, points, 0.02);
  EXPECT_NEAR(map.value, 0.25 + 0.01, 0.01);
  EXPECT_NEAR(coverage(o2, points, 0.02).value, map.value, 0.004);
  ASSERT_EQ(map.of_face.size(), o2.triangles.size());
  for (std::size_t f = 8; f < map.of_face.size(); ++f) EXPECT_EQ(map.of_face[f], 0);
  double covered = 0;
  for (const CoveragePiece& piece : map.pieces)
    covered +=
        piece.covered
            ? 0.5 * norm(cross(piece.corners[1] - piece.corners[0], piece.corners[2] - piece.corners[0]))
            : 0;
  EXPECT_LT(covered, 0.6);
}

TEST(SmokeMaps, ThreadsAndCancellationAreObeyed) {
  const Surface surface(torus(9, 7), {.resolution = 64});
  const Sites sites(sphere(1));
  const DistanceMap expected = compute_map(surface, sites);
  {
    const ThreadLimit one(1);
    EXPECT_EQ(compute_map(surface, sites).vector[surface.sample_texels()[7]],
              expected.vector[surface.sample_texels()[7]]);
  }
  std::vector<int> done(5);
  std::vector<std::function<void()>> tasks;
  for (int& entry : done) tasks.emplace_back([&entry] { entry = 1; });
  run_concurrently(tasks);
  EXPECT_THAT(done, ::testing::Each(1));
  std::string steps;
  (void)compute_map(surface, sites, {.progress = [&](std::string_view step, double) {
                      steps = step;
                      return true;
                    }});
  EXPECT_EQ(steps, "map");
  const std::atomic<bool> cancelled = true;
  const CancelScope scope(cancelled);
  EXPECT_THROW((void)compute_map(surface, sites), Cancelled);
}

}  // namespace
}  // namespace sdm::test
