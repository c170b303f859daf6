// What small meshes of usual shape do not reach: many faces, thin walls, solids that just touch, and wrong
// arguments.
#include <gtest/gtest.h>
#include <sdm/map_files.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "smoke/small_meshes.h"
#include "support/oracle.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

// Touching is a collision, to the last bit: of faces, of edges that cross, and of a corner on a face.
TEST(SmokeLimits, ConvexSolidsThatJustTouchAreDecidedExactly) {
  const double more = std::nextafter(2.0, 3.0);
  ProximityQuery cubes(cube(), cube());
  for (const Vec3& across : {Vec3{0, 0.3, 0.1}, Vec3{0, 0, 0}, Vec3{0, 2, 0}, Vec3{0, 2, 2}}) {
    cubes.set_pose(1, Transform::translation(Vec3{2, 0, 0} + across));
    EXPECT_TRUE(cubes.colliding());
    EXPECT_EQ(cubes.separation().value, 0);
    cubes.set_pose(1, Transform::translation(Vec3{more, 0, 0} + across));
    EXPECT_FALSE(cubes.colliding());
  }
  // An octahedron has its corner in the face; its edge crosses that of a turned box.
  Mesh octahedron{.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
                  .triangles = {},
                  .corner_uvs = {}};
  for (const std::uint32_t x : {0u, 1u})
    for (const std::uint32_t y : {2u, 3u})
      for (const std::uint32_t z : {4u, 5u})
        octahedron.triangles.push_back((x + y + z) % 2 == 0 ? Triangle{x, y, z} : Triangle{x, z, y});
  PoseQuery poses{Shape(octahedron), Shape(cube())};
  std::vector<Transform> all;
  for (const double x : {2.0, more, 2.5})
    for (int i = 0; i < 3; ++i) all.push_back(Transform::translation({x, 0.1 * i, 0.2}));
  const std::vector<std::uint8_t> colliding = poses.colliding(all);
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(colliding[i] != 0, i < 3) << i;
}

// Thousands of faces, whose nodes and leaves are told apart by cylinders and discs.
TEST(SmokeLimits, FineMeshesThatAreCloseAreTheirDistanceApart) {
  const Mesh ball = sphere(4), ring_mesh = torus(64, 48);
  ProximityQuery query(ball, ring_mesh);
  for (const double scale : {0.98, 0.9}) {
    query.set_pose(0, Transform::scaling(scale));
    EXPECT_NEAR(query.separation().value, 1 - scale, 0.004);
    EXPECT_FALSE(query.colliding());
  }
  query.set_pose(0, Transform::translation({0, 0, 0.4}));
  EXPECT_NEAR(query.separation().value, std::sqrt(4 + 0.16) - 2, 0.005) << "of the circle in the tube";
  query.set_pose(0, Transform::translation({0.05, 0, 0}));
  EXPECT_TRUE(query.colliding());
  EXPECT_NEAR(query.penetration_depth()->value, 0.05, 0.005);
  const HausdorffDistance hausdorff = one_sided_hausdorff(
      ball, Sites(mapped_by(sphere(3), [](const Vec3& p) { return 1.05 * p; })), {.precision = 0.002});
  EXPECT_NEAR(hausdorff.distance.value, 0.05, 0.01);
  const Motion rest{},
      fall{.from = Transform::translation({0, 0, 5}), .to = Transform::translation({0, 0, 1})};
  const TimeOfContact met = time_of_contact(Shape(ball), fall, Shape(ring_mesh), rest, 1e-4);
  EXPECT_FALSE(met.contact) << "it touches the hole in a circle only when its centre is there";
}

TEST(SmokeLimits, TheDepthOfShellsWithThinWallsIsThatOfTheirWalls) {
  const auto shell = [](double half, int n) {
    const Mesh outer = weld(grid_block({-half, -half, -half}, {half, half, half}, n)).mesh;
    const double inner = 0.95 * half;
    return joined(outer, flipped(weld(grid_block({-inner, -inner, -inner}, {inner, inner, inner}, n)).mesh));
  };
  ProximityQuery query(shell(1, 5), shell(1, 4), {.depth_precision = 0.002});
  query.set_pose(1, Transform::translation({0.4, 0.3, 0.2}));
  ASSERT_TRUE(query.colliding());
  EXPECT_LE(query.penetration_depth()->lower, 0.05 * std::sqrt(3.0));
  EXPECT_GE(query.penetration_depth()->upper, 0.025 - 1e-9) << "walls cross at right angles";
  EXPECT_LT(query.penetration_depth()->upper - query.penetration_depth()->lower, 0.01);
  EXPECT_GE(query.separating_translation().upper, query.penetration_depth()->lower - 1e-9);

  // Round walls.
  const auto bowl = [](int levels) {
    return joined(sphere(levels), flipped(mapped_by(sphere(levels), [](const Vec3& p) { return 0.96 * p; })));
  };
  ProximityQuery round(bowl(2), bowl(3));
  round.set_pose(1, Transform::translation({0.5, 0.1, 0}));
  EXPECT_TRUE(round.colliding());
  EXPECT_GT(round.penetration_depth()->upper, 0.01);
  EXPECT_LT(round.penetration_depth()->lower, 0.05);
}

// Hundreds of faces share a vertex.
TEST(SmokeLimits, FansOfManySliversIntersectNothing) {
  const Mesh many = fan(611);
  EXPECT_TRUE(is_embedded(Sites(many)));
  const Sites crossed(joined(many, many));
  EXPECT_FALSE(is_embedded(crossed));
  const SelfIntersections found = self_intersections(crossed, 10'000'000);
  EXPECT_TRUE(found.all);
  EXPECT_TRUE(std::ranges::is_sorted(found.pairs));
}

// As rough as scans are: most of the atlas would be gutters.
TEST(SmokeLimits, ChartsOfRoughMeshesOfManyFacesFollowTheSmoothedSurface) {
  Mesh mesh = grid_square(2, 0, 80);
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 0.02);
  for (Vec3& p : mesh.positions) p[2] += noise(random);
  const Surface surface(mesh, {.resolution = 512});
  EXPECT_LE(surface.max_stretch(), 4);
  EXPECT_LT(surface.chart_count(), 4096u);
  EXPECT_GT(surface.utilisation(), 0.3);
}

TEST(SmokeLimits, TolerancesThatDoNotContainZeroAreProven) {
  const Mesh small = cube(1), large = cube(1.1);
  const Sites around_small(small), around_large(large);
  EXPECT_EQ(prove_tolerance(large, around_small, Tolerance(0.09, 0.18)).proof, Proof::holds);
  const ToleranceProof low = prove_tolerance(large, around_small, Tolerance(0.11, 0.18));
  EXPECT_EQ(low.proof, Proof::fails);
  EXPECT_TRUE(low.at_lower);
  EXPECT_NEAR(low.witness->distance, 0.1, 1e-6);
  EXPECT_EQ(prove_tolerance(small, around_large, Tolerance(-0.2, -0.05)).proof, Proof::holds);
  EXPECT_EQ(prove_tolerance(large, around_small, Tolerance(-0.2, -0.05)).proof, Proof::fails);
  EXPECT_EQ(prove_tolerance(large, around_small, Tolerance(0.105, 0.18), {.accuracy = 0.01}).proof,
            Proof::undecided);
}

TEST(SmokeLimits, DistancesAlongNormalsAtVertices) {
  const Mesh sheet = grid_square(1, 0.25, 3);
  for (const float d : distances_at_vertices(sheet, Sites(grid_square(3, 0, 2)), AlongOptions{}))
    EXPECT_NEAR(d, 0.25, 1e-6);
}

TEST(SmokeLimits, TransferOfThreeAndFourComponentsAndFromMapsAlongLines) {
  const Mesh high = grid_square(2, 0.1, 3);
  const Surface surface(grid_square(1, 0, 2), {.resolution = 24});
  const Sites sites(high);
  for (const DistanceMap& map : {compute_map(surface, sites), compute_map(surface, sites, AlongOptions{}),
                                 compute_map(surface, sites, {.facing = 40})})
    for (const std::size_t components : {3, 4, 5}) {
      std::vector<float> values;
      for (const Vec3& p : high.positions)
        for (std::size_t k = 0; k < components; ++k) values.push_back(static_cast<float>(p[k % 2]));
      const std::vector<float> found = transfer(surface, sites, map, {values, components});
      for (const std::uint32_t t : surface.sample_texels())
        EXPECT_NEAR(found[components * t + 1], surface.texel_point(t)[1], 1e-6);
      EXPECT_GT(matches_of(surface, sites, map).count(MatchKind::none), 0u);
    }
}

TEST(SmokeLimits, EnumeratorsHaveNames) {
  for (const Verdict verdict : {Verdict::pass, Verdict::fail, Verdict::not_decided, Verdict::doubtful})
    EXPECT_STRNE(name_of(verdict), "");
  for (int i = 0; i <= static_cast<int>(VerdictReason::in_doubt); ++i)
    EXPECT_STRNE(name_of(static_cast<VerdictReason>(i)), "");
  for (int i = 0; i <= static_cast<int>(Colormap::paper2006); ++i)
    EXPECT_STRNE(name_of(static_cast<Colormap>(i)), "");
  for (int i = 0; i <= static_cast<int>(SignMethod::side); ++i)
    EXPECT_STRNE(name_of(static_cast<SignMethod>(i)), "");
  for (int i = 0; i <= static_cast<int>(DistanceKind::self); ++i)
    EXPECT_STRNE(name_of(static_cast<DistanceKind>(i)), "");
  for (int i = 0; i <= static_cast<int>(AtlasKind::uv); ++i)
    EXPECT_STRNE(name_of(static_cast<AtlasKind>(i)), "");
  for (int i = 0; i <= static_cast<int>(DoubtReason::thin_walls); ++i)
    EXPECT_STRNE(name_of(static_cast<DoubtReason>(i)), "");
  for (const GeometryChannel channel : kGeometryChannels) EXPECT_FALSE(name_of(channel).empty());
  for (const BakeChannel channel : kBakeChannels) EXPECT_FALSE(name_of(channel).empty());
}

// Verdicts in words, of each reason, by evidence.
TEST(SmokeLimits, VerdictsAreStatedWithTheirReason) {
  const Evidence good{.lowest = -0.1, .highest = 0.2, .accuracy = 1e-6, .error_bound = 0.05};
  const auto stated = [](const Evidence& evidence, const Tolerance& tolerance) {
    Summary summary;
    summary.units = "mm";
    summary.evidence = evidence;
    CertifiedVerdict verdict;
    static_cast<Judgement&>(verdict) = judge(evidence, tolerance);
    verdict.tolerance = tolerance;
    summary.tolerance = verdict;
    return std::pair(verdict.verdict, verdict_text(summary) + summary_json(summary));
  };
  Evidence close = good, incomplete = good, unmatched = good, estimated = good, unknown = good,
           samples = good;
  close.highest = 0.49;
  incomplete.complete = false;
  unmatched.complete = false;
  unmatched.unmatched = true;
  estimated.estimated_signs = true;
  unknown.accuracy = std::numeric_limits<double>::infinity();
  samples.samples_only = true;
  samples.error_bound = std::numeric_limits<double>::infinity();
  EXPECT_EQ(stated(good, 0.5).first, Verdict::pass);
  EXPECT_EQ(stated(good, 0.15).first, Verdict::fail);
  EXPECT_EQ(stated(close, 0.5).first, Verdict::not_decided);
  EXPECT_EQ(stated(incomplete, 0.5).first, Verdict::fail);
  EXPECT_EQ(stated(unmatched, 0.5).first, Verdict::fail);
  EXPECT_EQ(stated(estimated, Tolerance(-0.15, 0.5)).first, Verdict::not_decided);
  EXPECT_EQ(stated(unknown, 0.5).first, Verdict::not_decided);
  EXPECT_EQ(stated(samples, 0.5).first, Verdict::pass);
  EXPECT_EQ(stated({}, 0.5).first, Verdict::not_decided) << "nothing was measured";
  for (const Evidence& evidence : {good, close, incomplete, unmatched, estimated, unknown, samples})
    EXPECT_FALSE(stated(evidence, Tolerance(-0.15, 0.5)).second.empty());
}

TEST(SmokeLimits, ColorsFollowTheDistances) {
  DistanceStatistics distances;
  distances.min = -1;
  distances.max = 1;
  distances.p99_abs = 0.9;
  distances.p01 = -0.9;
  distances.p99 = 0.9;
  distances.texels = 100;
  distances.p05 = -0.8;
  distances.p95 = 0.8;
  EXPECT_EQ(color_range({}, distances).colormap, Colormap::diverging);
  EXPECT_EQ(color_range({.tolerance = Tolerance(0.2)}, distances).colormap, Colormap::automatic);
  EXPECT_EQ(color_range({.range = std::array{0.0, 2.0}}, distances).range[1], 2);
  EXPECT_THROW((void)color_range({.range = std::array{2.0, 0.0}}, distances), Error);
  distances.p05 = 0;
  EXPECT_EQ(color_range({}, distances).colormap, Colormap::sequential);
  const ColorRange one = color_range({}, distances);
  EXPECT_EQ(widest(one, {.colormap = Colormap::sequential, .range = {-1.5, 1}}).colormap,
            Colormap::diverging);
  EXPECT_EQ(color_range({.colormap = Colormap::paper2006}, distances).colormap, Colormap::paper2006);
  EXPECT_EQ(default_bands(Tolerance(0.2, 0.4), true).size(), 5u);
  EXPECT_EQ(default_bands(Tolerance(-std::numeric_limits<double>::infinity(), 0.4), true).size(), 3u);
}

template <class T>
T moved_twice(T object) {
  T other = std::move(object);
  object = std::move(other);
  return object;
}

TEST(SmokeLimits, ObjectsCanBeMoved) {
  const Mesh mesh = sphere(0);
  EXPECT_EQ(moved_twice(Sites(mesh)).mesh().triangles.size(), 20u);
  EXPECT_EQ(moved_twice(Surface(mesh, {.resolution = 32})).resolution(), 32u);
  EXPECT_GT(moved_twice(SamplingBound(Surface(mesh, {.resolution = 32}))).value(), 0);
  EXPECT_EQ(moved_twice(ProximityQuery(mesh, moved(mesh, {3, 0, 0}))).colliding(), false);
  EXPECT_EQ(moved_twice(MultiBodyQuery(std::vector<Mesh>{mesh})).size(), 1u);
  EXPECT_EQ(moved_twice(PoseQuery(Shape(mesh), Shape(mesh))).colliding(std::vector<Transform>(3)).size(), 3u);
  EXPECT_EQ(moved_twice(SelfProximityQuery(mesh)).sites().mesh().triangles.size(), 20u);
  EXPECT_EQ(moved_twice(Simplifier(mesh)).to_triangles(12).mesh.triangles.size(), 12u);
}

// One wrong argument for each: an error, whose message is made of what was given.
TEST(SmokeLimits, WrongArgumentsAreRefused) {
  const Mesh mesh = sphere(0);
  Sites sites(mesh);
  Surface surface(mesh, {.resolution = 32});
  const Surface other(mesh, {.resolution = 48});
  const DistanceMap map = compute_map(surface, sites), of_other = compute_map(other, sites);
  const std::vector<Vec3> bad{{std::nan(""), 0, 0}}, one{{0, 0, 3}}, none;
  const double infinite = std::numeric_limits<double>::infinity();
  const std::vector<float> few(3);
  const std::vector<std::function<void()>> calls{
      [&] { (void)make_engine("none"); },
      [&] { (void)closest_points(sites, bad); },
      [&] { (void)closest_points(sites, one, {.max_distance = -1}); },
      [&] { (void)closest_facing_points(sites, one, none, 30); },
      [&] { (void)closest_facing_points(sites, one, one, 200); },
      [&] { (void)point_on_face(sites, SiteType::vertex, 99, {}); },
      [&] { (void)compute_map(surface, sites, {.max_distance = 0}); },
      [&] { (void)compute_map(surface, Sites(square(1, 0)), {.sign = SignMethod::exact}); },
      [&] { (void)compute_map(surface, sites, AlongOptions{.direction = Vec3{}}); },
      [&] { (void)closest_points_along(sites, one, none, {}); },
      [&] { (void)closest_points_along(sites, bad, one, {}); },
      [&] {
        (void)first_hits(sites, std::vector<Ray>{{bad[0], {0, 0, 1}}});
      },
      [&] {
        (void)first_hits(sites, std::vector<Ray>{{one[0], {0, 0, 0}}});
      },
      [&] {
        (void)occluded(sites, std::vector<Ray>{{one[0], {0, 0, 1}, -1}});
      },
      [&] { (void)free_distances(surface, sites, of_other); },
      [&] { (void)ambient_occlusion(surface, sites, map, {.rays = 0}); },
      [&] { (void)statistics(surface, of_other); },
      [&] {
        (void)distance_histogram(surface, map, {1, 0}, 3);
      },
      [&] {
        (void)distance_bands(surface, map, std::vector<double>{1, 0});
      },
      [&] { (void)extremes(surface, map, few); },
      [&] { (void)find_places(surface, of_other, {}, {}); },
      [&] { (void)part_statistics(surface, map, std::vector<std::uint32_t>(3), 1); },
      [&] { (void)tolerance_shares(surface, of_other, 1, 0); },
      [&] {
        (void)boundary_mask(
            Sites(single_triangle()),
            compute_map(other, Sites(mapped_by(sphere(1), [](const Vec3& p) { return 0.1 * p; }))));
      },
      [&] {
        (void)transfer(surface, sites, map, {few, 1});
      },
      [&] {
        (void)transfer(surface, sites, of_other, {std::vector<float>(12), 1});
      },
      [&] {
        (void)transfer(surface, sites, map, {few, 1, AttributeDomain::face});
      },
      [&] { (void)match_texels(surface, sites, {.method = MatchMethod::ray, .cage = -1}); },
      [&] { (void)matches_of(surface, sites, of_other); },
      [&] { (void)compute_map(surface, Sites(mesh), ThicknessOptions{.angle = 0}); },
      [&] {
        (void)compute_map(Surface(square(1, 0), {.resolution = 32}), Sites(square(1, 0)), ThicknessOptions{});
      },
      [&] { (void)compute_map(surface, sites, SelfOptions{.exclusion = Exclusion(cube())}); },
      [&] { (void)Exclusion(mesh, {.rule = {.rings = 0}}); },
      [&] { (void)Exclusion(mesh, {.rule = {.geodesic = -1}}); },
      [&] { (void)coverage(mesh, sites, 0); },
      [&] { (void)coverage(mesh, none, 1); },
      [&] { (void)one_sided_hausdorff(mesh, sites, {.precision = 0}); },
      [&] { (void)one_sided_hausdorff(mesh, sites, {.facing = 0}); },
      [&] { (void)surface_metrics(mesh, mesh, {.percentiles = {100}}); },
      [&] { (void)surface_metrics(mesh, mesh, {.tolerances = {-1}}); },
      [&] { (void)prove_tolerance(mesh, sites, Tolerance(1, 0)); },
      [&] { (void)prove_tolerance(mesh, Sites(square(1, 0)), Tolerance(-1, 2)); },
      [&] { (void)prove_tolerance(mesh, sites, 1, {.faces = std::vector<std::uint32_t>{99}}); },
      [&] { (void)Simplifier(mesh).to_deviation(0); },
      [&] { (void)Simplifier(mesh).to_triangles(0); },
      [&] {
        (void)make_grid({}, {2, 2, 2});
      },
      [&] {
        (void)make_grid(bounds(mesh), {0, 2, 2});
      },
      [&] { (void)make_grid(bounds(mesh), -1); },
      [&] {
        (void)compute_field(sites, make_grid(bounds(mesh), {2, 2, 2}), {.max_distance = 0});
      },
      [&] { (void)sample_field({}, bad); },
      [&] { (void)align(mesh, sites, {.samples = 1}); },
      [&] { (void)align(none, none, sites); },
      [&] { (void)align(mesh, sites, {.pose = Transform::scaling(2)}); },
      [&] { (void)align_321(one, one); },
      [&] { (void)ProximityQuery(mesh, mesh, {.depth_precision = 0}); },
      [&] { ProximityQuery(mesh, mesh).set_pose(2, {}); },
      [&] {
        ProximityQuery(mesh, mesh).set_pose(0, Transform::translation({infinite, 0, 0}));
      },
      [&] { ProximityQuery(mesh, mesh).refit(one, {}); },
      [&] { (void)ProximityQuery(mesh, mesh).separating_contacts(0); },
      [&] { (void)MultiBodyQuery(std::vector<Mesh>{mesh}).pose(3); },
      [&] { MultiBodyQuery(std::vector<Mesh>{mesh}).exclude_pair(0, 0); },
      [&] { (void)MultiBodyQuery(std::vector<Mesh>{mesh}).separations(0); },
      [&] { (void)MultiBodyQuery(std::vector<Mesh>{mesh}).nearest_map(0); },
      [&] { (void)MultiBodyQuery(std::vector<Mesh>{mesh}).time_of_contact({}, 1); },
      [&] { MultiBodyQuery(std::vector<Mesh>{mesh}).set_poses({}); },
      [&] { (void)MultiBodyQuery(std::vector<std::vector<BodyPart>>{{}}); },
      [&] { PoseQuery(Shape(mesh), Shape(mesh)).set_pose(1, {}); },
      [&] { (void)PoseQuery(Shape(mesh), Shape(mesh)).separations(std::vector<Transform>(1), 0); },
      [&] {
        (void)PoseQuery(Shape(mesh), Shape(mesh)).colliding(std::vector<Transform>{Transform::scaling(0)});
      },
      [&] { (void)time_of_contact(Shape(mesh), {}, Shape(mesh), {}, 0); },
      [&] { (void)SelfProximityQuery(mesh, {.max_distance = 0}); },
      [&] { (void)SelfProximityQuery(mesh).contacts(-1); },
      [&] { (void)remove_islands(mesh, {.faces = 999}); },
      [&] { (void)remove_islands(mesh, {.area_fraction = 2}); },
      [&] { (void)weld(mesh, {.tolerance = 0}); },
      [&] { (void)uv_tiles(mesh); },
      [&] { (void)Surface(mesh, {.resolution = 8}); },
      [&] { (void)Surface(mesh, {.kind = AtlasKind::uv}); },
      [&] { (void)Surface(mesh, {.resolution = 32}, std::vector<std::uint8_t>(7)); },
      [&] { surface.refit(one); },
      [&] { sites.refit(one); },
      [&] { sites.edit({.removed_faces = {99}}); },
      [&] {
        sites.edit({.removed_faces = {1, 1}});
      },
      [&] {
        surface.edit({.added_faces = {{0, 0, 0}}});
      },
      [&] { surface.edit({.moved_vertices = {{.vertex = 99, .position = {}}}}); },
      [&] { (void)RelativeError(other, SamplingBound(Surface(cube(), {.resolution = 32}))); },
      [&] { SamplingBound(surface).refit(Surface(cube(), {.resolution = 32})); },
      [&] { (void)resolution_for(mesh, 0); },
      [&] { (void)resolution_for(mesh, 1e-9); },
      [&] {
        TemporalMaps maps;
        maps.add(map);
        maps.add(of_other);
      },
      [&] { (void)TemporalMaps(TemporalMaps::State{.maps = 1, .resolution = 3}); },
      [&] {
        TemporalMaps().follow_edit(std::vector<std::uint32_t>(3), surface);
        TemporalMaps maps;
        maps.add(map);
        maps.follow_edit(std::vector<std::uint32_t>(3), surface);
      },
      [&] { (void)sample_layout({.resolution = 32768}, 8); },
      [&] { (void)mean_of_samples({.resolution = 6, .side = 3}, 1, few); },
      [&] {
        (void)scalar_image(3, few, {1, 0});
      },
      [&] { (void)normal_map_image(3, few); },
      [&] { (void)smooth_normals(mesh, -1); },
      [&] {
        (void)Transform::quaternion({0, 0, 0, 0});
      },
      [&] { (void)Transform::scaling(0).inverse(); },
      [&] { (void)solid_volume(Sites(square(1, 0))); },
      [&] {
        (void)fit_to_unit({.positions = {{0, 0, 0}}, .triangles = {}, .corner_uvs = {}});
      },
      [&] { (void)Shape(mesh).surface(); },
      [&] {
        (void)certify_tolerance(Surface(mesh, {.resolution = 32}), Sites(square(1, 0)),
                                compute_map(Surface(mesh, {.resolution = 32}), Sites(square(1, 0))),
                                std::vector<float>(12), Tolerance(-1, 2), {});
      },
      [&] { (void)read_channels(channels(), {.map = &map}, std::vector<std::uint32_t>{0}); },
      [&] { (void)inside_flags(sites, one, {}, SignMethod::exact); },
  };
  for (std::size_t i = 0; i < calls.size(); ++i) EXPECT_THROW(calls[i](), Error) << "call " << i;
  for (Mesh wrong :
       {Mesh{.positions = {{0, 0, 0}}, .triangles = {{0, 1, 2}}, .corner_uvs = {}},
        Mesh{.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, .triangles = {{0, 1, 2}}, .corner_uvs = {}},
        Mesh{.positions = {{0, 0, 0}, {1, infinite, 0}, {2, 0, 0}},
        .triangles = {{0, 1, 2}},
        .corner_uvs = {}},
        Mesh{.positions = {{0, 0, 0}, {1e38, 1, 0}, {2, 0, 0}}, .triangles = {{0, 1, 2}}, .corner_uvs = {}},
        Mesh{.positions = {{0, 0, 0}, {1e-35, 0, 0}, {0, 1e-35, 0}},
        .triangles = {{0, 1, 2}},
        .corner_uvs = {}},
        Mesh{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
        .triangles = {{0, 1, 2}, {0, 2, 1}},
        .corner_uvs = {{}}}})
    EXPECT_THROW(validate(wrong), Error);
}

}  // namespace
}  // namespace sdm::test
