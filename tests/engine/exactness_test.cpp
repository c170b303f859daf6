// Every texel of every map, with every set of vector instructions of the machine, against CGAL's AABB
// tree.
#include <gmock/gmock.h>
#include <sdm/gpu.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "support/engines.h"
#include "support/error_of.h"
#include "support/gpu_closest.h"
#include "support/map_checks.h"
#include "support/meshes.h"
#include "support/oracle.h"
#include "support/points.h"
#include "support/shapes.h"
#include "support/simd_targets.h"

namespace sdm {
namespace {

using ::testing::HasSubstr;

struct Scene {
  const char *o1, *steps1, *o2, *steps2;
  std::uint32_t resolution;
};
void PrintTo(const Scene& s, std::ostream* out) {
  *out << s.o1 << " [" << s.steps1 << "] " << s.o2 << " [" << s.steps2 << ']';
}

const Scene kScenes[] = {
    // The pair of the benchmarks, close together and penetrating.
    {"bunny.obj", "fit", "armadillo.off", "fit,translate:0.8:0:0", 512},
    {"bunny.obj", "fit", "armadillo.off", "fit", 256},
    {"armadillo.off", "fit", "bunny.obj", "fit,translate:0.8:0:0", 512},
    {"armadillo.off", "fit", "bunny.obj", "fit", 256},
    // In file coordinates: the bunny is fifty times smaller, and elsewhere.
    {"armadillo.off", "", "bunny.obj", "", 256},
    {"bunny.obj", "", "armadillo.off", "", 256},
    // Holes, many components, polygons, non-manifold and degenerate faces.
    {"elephant-with-holes.off", "fit", "lion-head.off", "fit,translate:0.3:0.2:0.1", 256},
    {"blobby_3cc.off", "fit", "bear_bis.off", "fit", 256},
    {"dino.off", "fit", "boeing.off", "fit", 256},
    {"boeing.off", "fit", "b9_mesh.off", "fit,rotate:0:90:0", 256},
    {"ALSTOM_TEST4.off", "fit", "polygon_mesh.off", "fit,rotate:30:60:90", 256},
    {"triceratops.off", "fit", "degtri_sliding.off", "fit,translate:0.4:0:0", 256},
    {"degtri_sliding.off", "", "tetra_intersected_by_triangle.off", "", 128},
    {"mech-holes-shark.off", "fit", "pig.off", "fit", 256},
    {"cheese.off", "fit", "anchor_dense.off", "fit,rotate:45:0:0,translate:0:1:0", 256},
    {"mpi.off", "fit", "horizons.off", "fit,translate:0:0:0.2", 256},
    {"knot2.off", "fit", "cylinder_locally_refined.off", "fit", 256},
    {"ChineseDragon-10kv.off", "fit", "turbine.off", "fit,scale:30,translate:100:0:0", 128},
    {"head.off", "fit", "triangle.off", "fit,translate:0.2:0.3:0", 256},
    {"triangle.off", "fit", "retinal.off", "fit", 128},
    {"corner_tris_with_hole.off", "fit", "cross.off", "fit,scale:0.001", 128},
};

// The map on the device: within its error, or refused where a sample is too far away.
void expect_map_on_device(const Surface& surface, const Sites& sites, std::span<const double> expected) {
  const Box o2 = bounds(sites.mesh());
  const double size = norm(o2.upper - o2.lower);
  if (*std::ranges::max_element(expected) > 20 * size) {
    EXPECT_THAT(test::error_of([&] { return GpuMap(surface, sites); }), HasSubstr("too far"));
    return;
  }
  const GpuMap map(surface, sites, {.closest = true});
  const std::vector<float> found = map.distances();
  ASSERT_EQ(found.size(), expected.size());
  std::size_t wrong = 0;
  double sum = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    wrong += std::abs(found[i] - expected[i]) <= map.error(found[i]) ? 0 : 1;
    sum += expected[i];
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(test::wrong_closest(map, sites, sites.mesh(), surface.sample_points(), expected), 0u);
  const double tolerance = expected[expected.size() / 2];
  const auto within = static_cast<std::uint64_t>(
      std::ranges::count_if(expected, [&](double distance) { return distance <= tolerance; }));
  const GpuMapStatistics all = map.statistics(tolerance);
  EXPECT_EQ(all.samples, expected.size());
  EXPECT_NEAR(all.mean, sum / static_cast<double>(expected.size()), all.error);
  EXPECT_NEAR(all.largest, *std::ranges::max_element(expected), all.error);
  EXPECT_NEAR(all.smallest, *std::ranges::min_element(expected), all.error);
  EXPECT_LE(all.within, within);
  EXPECT_LE(all.beyond, expected.size() - within);
}

void expect_agreement(const Mesh& o1, const Mesh& o2, const AtlasOptions& atlas) {
  const Surface surface(o1, atlas);
  const Sites sites(o2);
  const double tolerance = 1e-6 * test::scene_diagonal(o1, o2);
  ASSERT_GT(surface.sample_texels().size(), 100u);

  const std::vector<Vec3> points = surface.sample_points();
  const std::vector<double> expected = test::evaluate(oracle::CgalDistance(o2), points);
  std::optional<DistanceMap> reference;
  for (const test::EngineOnTarget& engine : test::engines_on_targets()) {
    SCOPED_TRACE(testing::PrintToString(engine));
    const test::UseSimdTarget target(engine.target);
    const DistanceMap map = compute_map(surface, sites, {.engine = make_engine(engine.name)});
    test::expect_map(surface, sites, map, expected, tolerance);
    if (!reference) reference = map;
    test::Disagreements from_reference(tolerance);
    for (const std::uint32_t t : surface.sample_texels())
      from_reference.compare(t, map.distance[t], reference->distance[t]);
    EXPECT_TRUE(from_reference.none());
  }
  for (const std::string& engine : test::engine_names_with_gpu()) {
    SCOPED_TRACE(engine);
    test::expect_closest_points(sites, points, closest_points(sites, points, {.engine = make_engine(engine)}),
                                expected, tolerance);
    if (engine == "gpu") expect_map_on_device(surface, sites, expected);
  }
}

class Exactness : public testing::TestWithParam<Scene> {};

TEST_P(Exactness, EveryTexelAgreesWithCgal) {
  const Scene& scene = GetParam();
  expect_agreement(test::load(scene.o1, scene.steps1), test::load(scene.o2, scene.steps2),
                   {.resolution = scene.resolution});
}

std::string scene_name(const testing::TestParamInfo<Scene>& info) {
  std::string text = std::to_string(info.index) + "_" + info.param.o1 + "_to_" + info.param.o2;
  std::ranges::replace_if(
      text, [](unsigned char c) { return !std::isalnum(c); }, '_');
  return text;
}
INSTANTIATE_TEST_SUITE_P(Scenes, Exactness, testing::ValuesIn(kScenes), scene_name);

// The scenes must keep covering all awkward kinds of meshes.
TEST(Exactness, ScenesCoverAllKindsOfMeshes) {
  bool open = false, degenerate = false, many = false, pinched = false;
  for (const Scene& scene : kScenes) {
    const MeshInfo info = inspect(test::load(scene.o2));
    open |= info.boundary_edges > 0;
    degenerate |= info.degenerate_faces > 0;
    many |= info.components > 1;
    pinched |= info.nonmanifold_vertices > 0;
  }
  EXPECT_TRUE(open && degenerate && many && pinched);
}

// Defects that no installed file has.
TEST(Exactness, MeshWithDefects) {
  const Mesh mesh = test::with_defects(test::load("blobby.off", "fit"));
  const MeshInfo info = inspect(mesh);
  ASSERT_GT(info.nonmanifold_edges, 0u);
  ASSERT_GT(info.degenerate_faces, 0u);
  ASSERT_GT(info.duplicate_faces, 0u);
  ASSERT_FALSE(info.oriented);
  expect_agreement(test::load("head.off", "fit"), mesh, {.resolution = 256});
  expect_agreement(mesh, test::load("head.off", "fit"),
                   {.resolution = 512});  // flipped faces make many charts
}

// Texels that are longer one way on the surface.
TEST(Exactness, MapsThatAreNotSquare) {
  const Mesh mesh = test::with_own_uvs(test::load("blobby.off", "fit"));
  const Mesh other = test::load("bear_bis.off", "fit");
  for (const auto& [columns, rows] : {std::pair(640u, 90u), std::pair(61u, 515u)})
    expect_agreement(mesh, other, {.kind = AtlasKind::uv, .resolution = columns, .rows = rows});
}

}  // namespace
}  // namespace sdm
