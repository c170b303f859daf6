// The gpu engine: its closest points are those of the reference engine, to the bit.

#include <gmock/gmock.h>
#include <sdm/sdm.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <span>
#include <thread>
#include <vector>

#include <sdm/gpu.h>
#include "closest/engine.h"  // IWYU pragma: keep, of shared pointers
#include "gpu/face_search.h"
#include "gpu/finish.h"
#include "support/degenerate.h"
#include "support/error_of.h"
#include "support/meshes.h"
#include "support/points.h"

namespace sdm {
namespace {

using ::testing::HasSubstr;

// On the surface, near it, in its box, around it and far away; and on vertices and beyond the ends of edges.
std::vector<Vec3> queries_for(const Mesh& mesh, std::size_t count, std::mt19937& random) {
  const Box box = bounds(mesh);
  const Vec3 centre = 0.5 * (box.lower + box.upper), half = 0.5 * (box.upper - box.lower);
  const double size = norm(half);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<Vec3> queries = test::random_surface_points(mesh, count, random);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 direction{unit(random), unit(random), unit(random)};
    const double far = std::pow(10.0, static_cast<double>(i % 9) - 7);
    switch (i % 4) {
      case 0:
        queries[i] = queries[i] + far * size * direction;
        break;
      case 1:
        queries[i] = centre + 3 * size * direction;
        break;
      case 2: {
        const Triangle& t = mesh.triangles[i % mesh.triangles.size()];
        const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]];
        queries[i] = i % 8 == 2 ? a : a + (2 + direction[0]) * (b - a);
        break;
      }
      default:
        break;
    }
  }
  return queries;
}

void expect_reference(const Mesh& mesh, double max_distance, std::uint32_t seed) {
  std::mt19937 random(seed);
  const Sites sites(mesh);
  const std::vector<Vec3> points = queries_for(mesh, 20'000, random);
  const auto of = [&](const char* engine) {
    std::vector<ClosestPoint> found(points.size());
    make_engine(engine)->scattered(sites, points, {.max_distance = max_distance}, found);
    return found;
  };
  const std::vector<ClosestPoint> found = of("gpu"), expected = of("reference");
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_EQ(found[i].type, expected[i].type) << i;
    if (expected[i].type == SiteType::none) continue;
    ASSERT_EQ(found[i].distance, expected[i].distance) << i;
    ASSERT_EQ(found[i].site, expected[i].site) << i;
    ASSERT_EQ(found[i].point, expected[i].point) << i;
  }
}

TEST(GpuEngine, ClosestPointsAreThoseOfTheReferenceEngine) {
  constexpr double kAnywhere = std::numeric_limits<double>::infinity();
  expect_reference(test::load("armadillo.off"), kAnywhere, 1);
  expect_reference(test::load("elephant-with-holes.off"), kAnywhere, 2);
  expect_reference(test::load("boeing.off"), 0.3, 3);
  for (std::uint32_t seed = 4; seed < 12; ++seed) {
    std::mt19937 random(seed);
    Mesh mesh = test::degenerate_soup(300, random);
    const double scale = std::pow(10.0, 3.0 * (seed % 5) - 6);
    for (Vec3& p : mesh.positions) p = scale * (p + Vec3{3, 0, -5});
    expect_reference(mesh, seed % 2 == 0 ? kAnywhere : 0.2 * scale, seed);
  }
}

TEST(GpuEngine, ManyFacesAtTheSameDistance) {
  // A point above the tip of a fan of more faces than a list has room for.
  Mesh fan;
  fan.positions = {{0, 0, 1}};
  constexpr std::uint32_t kFaces = 40;
  for (std::uint32_t i = 0; i < kFaces; ++i) {
    const double angle = 2 * 3.14159265358979 * i / kFaces;
    fan.positions.push_back({std::cos(angle), std::sin(angle), 0});
    fan.triangles.push_back({0, 1 + i, 1 + (i + 1) % kFaces});
  }
  const Sites sites(fan);
  const auto engine = make_gpu_engine({});
  const std::vector<ClosestPoint> found =
      closest_points(sites, std::vector<Vec3>{{0, 0, 2}}, {.engine = engine});
  EXPECT_EQ(found[0].type, SiteType::vertex);
  EXPECT_EQ(found[0].site, 0u);
  EXPECT_EQ(found[0].distance, 1);
  EXPECT_EQ(gpu_report(*engine)->incomplete, 1u);
}

TEST(GpuEngine, FollowsRefitsAndEdits) {
  Mesh mesh = test::load("cow.off", "fit");
  Sites sites(mesh);
  const std::vector<Vec3> points{{0.1, 0.2, 0.3}, {2, 0, 0}};
  for (int frame = 0; frame < 6; ++frame) {
    for (Vec3& p : mesh.positions) p = 1.1 * p + Vec3{0.01, 0, 0};
    if (frame < 4) {
      sites.refit(mesh.positions);
    } else {
      // The closest face is no more.
      const ClosestPoint closest = closest_points(sites, points, {})[0];
      sites.edit({.removed_faces = {point_on_face(sites, closest.type, closest.site, points[0]).face}});
    }
    const auto found = closest_points(sites, points, {.engine = make_engine("gpu")}),
               expected = closest_points(sites, points, {.engine = make_engine("reference")});
    for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(found[i].distance, expected[i].distance);
  }
}

TEST(GpuEngine, MapsBesideEachOtherAndCancellation) {
  const Surface surface(test::load("cow.off", "fit"), {.resolution = 256});
  const Sites sites(test::load("head.off", "fit,translate:0.5:0:0"));
  MapOptions options{.engine = make_engine("gpu")};
  const auto map = [&] { return compute_map(surface, sites, options).distance; };
  const std::vector<float> expected =
      compute_map(surface, sites, {.engine = make_engine("reference")}).distance;
  const auto same = [&](const std::vector<float>& found) {
    return std::memcmp(found.data(), expected.data(), expected.size() * sizeof(float)) == 0;
  };
  std::vector<float> other;
  std::jthread beside([&] { other = map(); });
  EXPECT_TRUE(same(map()));
  beside.join();
  EXPECT_TRUE(same(other));
  options.progress = [](std::string_view, double) { return false; };
  EXPECT_THROW(map(), Cancelled);
  options.progress = {};
  EXPECT_TRUE(same(map()));
}

TEST(GpuEngine, UnknownDevice) {
  EXPECT_THAT(test::error_of([] { return make_gpu_engine({.device = "no such device"}); }),
              HasSubstr("no device 'no such device'"));
}

// A device that permits less memory than O2 takes has it in parts.
TEST(GpuEngine, BuffersBeyondTheLimitAreDivided) {
  const Sites sites(test::load("armadillo.off", "fit"));
  const sites::SitesData& o2 = internals(sites);
  std::mt19937 random(1);
  std::vector<Vec3> points = queries_for(sites.mesh(), 24 * gpu::FaceSearch::kTile, random);
  const std::vector<ClosestPoint> expected =
      closest_points(sites, points, {.engine = make_engine("reference")});
  std::vector<gpu::QueryPoint> placed(points.size());
  gpu::place_points(o2, points, kInfinity, placed);
  for (const std::size_t bytes : {200'000u, 1'500'000u, 100'000'000u}) {
    gpu::FaceSearch search("");
    search.device().permit(bytes);
    gpu::FaceLists found;
    gpu::SearchTimes times;
    search.find(o2, placed, found, times);
    const auto least = sites.mesh().triangles.size() * 80 / bytes + 1;
    EXPECT_GE(found.first.size(), least);
    EXPECT_EQ(found.first.size() == 1, least == 1);
    std::size_t wrong = 0;
    gpu::finish(
        o2, points, placed, found, 0, kInfinity, [&](std::size_t first, const sites::ClosestPacket& closest) {
          for (std::size_t i = 0; i < closest.count; ++i) {
            const ClosestPoint& c = expected[first + i];
            wrong +=
                closest.distance[i] != c.distance || closest.type[i] != c.type || closest.site[i] != c.site;
          }
        });
    EXPECT_EQ(wrong, 0u) << bytes;

    // Samples at vertices, of which each is one of the points.
    gpu::Device& device = search.device();
    std::vector<gpu::Sample> samples;
    std::vector<float> positions;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      samples.push_back({{i, i, i}, {}});
      for (const float x : placed[i].position) positions.push_back(x);
    }
    using Use = gpu::Device::Use;
    const std::size_t size = points.size() * sizeof(float);
    const gpu::Buffer distances = device.buffer(size, Use::write, ""),
                      read_back = device.buffer(size, Use::read_back, ""),
                      samples_there = device.buffer(samples.size() * sizeof(gpu::Sample), Use::read, ""),
                      positions_there = device.buffer(3 * size, Use::read, "");
    device.write(samples_there, std::as_bytes(std::span(samples)));
    device.write(positions_there, std::as_bytes(std::span(positions)));
    search.measure(o2, {samples_there, positions_there}, points.size(), distances);
    std::vector<float> on_device(points.size());
    device.run({}, distances, read_back, std::as_writable_bytes(std::span(on_device)));
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (placed[i].within < 0) continue;
      const auto& [x, y, z] = placed[i].position;
      const gpu::DistanceError error =
          gpu::distance_error(o2, std::max({std::abs(x), std::abs(y), std::abs(z)}));
      const double distance = expected[i].distance * o2.frame.scale;
      ASSERT_NEAR(on_device[i], distance, error.each * distance + error.constant) << i;
    }
  }
}

TEST(GpuEngine, LostDevice) {
  const Sites sites(test::load("cow.off", "fit"));
  gpu::FaceSearch search("");
  const std::vector<gpu::QueryPoint> points(gpu::FaceSearch::kTile, {{0, 0, 0}, 1e18f});
  gpu::FaceLists found;
  gpu::SearchTimes times;
  search.find(internals(sites), points, found, times);
  EXPECT_GT(found.of(0, 0).count(), 0u);
  search.device().lose();
  EXPECT_THAT(test::error_of([&] { search.find(internals(sites), points, found, times); }),
              HasSubstr("lost"));
}

}  // namespace
}  // namespace sdm
