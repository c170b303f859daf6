// Known motions are recovered; what O2 does not determine is reported.
#include <gmock/gmock.h>
#include <sdm/align.h>
#include <sdm/doubts.h>
#include <sdm/error.h>
#include <sdm/execution.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "geometry/vec.h"
#include "support/error_of.h"
#include "support/meshes.h"
#include "support/points.h"
#include "support/shapes.h"

namespace sdm {
namespace {

using namespace test;
using ::testing::HasSubstr;

constexpr std::size_t kSamples = 4096;

double size_of(const Mesh& mesh) {
  return diagonal(bounds(mesh));
}

/// A rotation by 2° in all about the centre, then a translation by 2 % of the size.
Transform small_motion(const Mesh& mesh) {
  const Vec3 centre = core::centre(bounds(mesh));
  const double shift = 0.02 * size_of(mesh) / std::sqrt(3);
  return Transform::translation(centre + Vec3{shift, -shift, shift}) * Transform::rotation({1.2, 1.2, -1.2}) *
         Transform::translation(-centre);
}

Mesh image(Mesh mesh, const Transform& map) {
  transform(mesh, map);
  return mesh;
}

/// The largest distance of a corner of the bounds from its place.
double displacement(const Mesh& mesh, const Transform& map) {
  const Box box = bounds(mesh);
  double largest = 0;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 p;
    for (int k = 0; k < 3; ++k) p[k] = corner >> k & 1 ? box.upper[k] : box.lower[k];
    largest = std::max(largest, norm(map(p) - p));
  }
  return largest;
}

/// Without the `share` of the faces that lie farthest along a direction.
Mesh cut(const Mesh& mesh, double share, const Vec3& direction) {
  const auto height = [&](const Triangle& t) {
    return dot(mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]], direction);
  };
  Mesh result = mesh;
  result.corner_uvs.clear();
  std::ranges::sort(result.triangles, {}, height);
  result.triangles.resize(static_cast<std::size_t>((1 - share) * static_cast<double>(mesh.triangles.size())));
  return result;
}

/// With triangles far from the surface, 1 % of the number of faces and as large.
Mesh with_outliers(Mesh mesh, std::mt19937& random) {
  const Box box = bounds(mesh);
  const double side = std::sqrt(2 * inspect(mesh).area / static_cast<double>(mesh.triangles.size()));
  mesh.corner_uvs.clear();
  for (std::size_t i = 0, count = mesh.triangles.size() / 100 + 1; i < count; ++i) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const Vec3 p = random_point(box, random);
    for (const Vec3& offset : {Vec3{}, Vec3{side, 0, 0}, Vec3{0, side, 0}})
      mesh.positions.push_back(p + offset);
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

Mesh with_noise(Mesh mesh, double deviation, std::mt19937& random) {
  std::normal_distribution<double> noise(0, deviation);
  for (Vec3& p : mesh.positions)
    for (double& x : p) x += noise(random);
  return mesh;
}

/// A block with a ring through its top and another on its side: no symmetry.
Mesh bracket() {
  Mesh block = cube(1);
  for (Vec3& p : block.positions) p = {3 * p[0], 1.5 * p[1], p[2]};
  return joined(joined(block, ring(24, 1.2, {1.5, 0.2, 1.1})), ring(20, 0.5, {-2.5, 1.4, 0.3}));
}

struct Body {
  const char* name;
  Mesh mesh;
};

std::vector<Body> bodies() {
  return {{"bracket", bracket()},         {"cube", cube()},      {"height field", height_field(40)},
          {"tetrahedron", tetrahedron()}, {"wedge", wedge(0.3)}, {"head", load("head.off")}};
}

std::size_t free_count(const Alignment& alignment) {
  return static_cast<std::size_t>(std::ranges::count(alignment.freedoms, true, &DegreeOfFreedom::free));
}

TEST(Align, FindsTheMotionOfACopyToRounding) {
  for (const auto& [name, mesh] : bodies()) {
    const Transform motion = small_motion(mesh);
    const Alignment found = align(image(mesh, motion), Sites(mesh), {.samples = kSamples});
    EXPECT_TRUE(found.converged) << name;
    EXPECT_LT(displacement(mesh, found.transform * motion), 1e-9 * size_of(mesh)) << name;
    EXPECT_EQ(free_count(found), 0u) << name;
    EXPECT_NEAR(found.transform.determinant(), 1, 1e-14) << name;
    EXPECT_LT(found.after.rms, 1e-9 * size_of(mesh)) << name;
    EXPECT_GT(found.before.rms, 1e-3 * size_of(mesh)) << name;
    EXPECT_LT(found.before.trimmed_rms, 1.0001 * found.before.rms) << name;
  }
}

TEST(Align, SizeAndPlaceDoNotMatter) {
  const Mesh mesh = bracket();
  for (const double scale : {1e-12, 1e9}) {
    const Mesh o2 = image(mesh, Transform::scaling(scale) * Transform::translation({1000, -2000, 500}));
    const Transform motion = small_motion(o2);
    const Alignment found = align(image(o2, motion), Sites(o2), {.samples = kSamples});
    EXPECT_TRUE(found.converged);
    EXPECT_LT(displacement(o2, found.transform * motion), 1e-9 * size_of(o2)) << scale;
  }
}

TEST(Align, WorksWithAPartOfTheSurface) {
  for (const auto& [name, mesh] : bodies()) {
    if (mesh.triangles.size() < 100) continue;
    const Transform motion = small_motion(mesh);
    for (const Vec3& direction : {Vec3{1, 0.3, 0.2}, Vec3{-0.2, -1, 0.5}}) {
      const Mesh part = cut(mesh, 0.3, direction);
      const Alignment scan = align(image(part, motion), Sites(mesh), {.samples = kSamples});
      EXPECT_LT(displacement(mesh, scan.transform * motion), 1e-9 * size_of(mesh)) << name;
      const Alignment reference = align(image(mesh, motion), Sites(part), {.samples = kSamples});
      EXPECT_LT(displacement(mesh, reference.transform * motion), 1e-9 * size_of(mesh)) << name << ", O2 cut";
    }
  }
}

// The errors are those of the noise divided by the square root of the number of vertices, times small
// factors.
TEST(Align, IsNotMisledByNoiseAndOutliers) {
  std::mt19937 random(5);
  for (const char* name : {"head.off", "elephant.off"}) {
    const Mesh mesh = load(name);
    const double size = size_of(mesh), deviation = 5e-4 * size;
    const Transform motion = small_motion(mesh);
    const Mesh scan = with_outliers(with_noise(cut(mesh, 0.3, {0.3, -0.2, 1}), deviation, random), random);
    const Alignment found = align(image(scan, motion), Sites(mesh), {.samples = kSamples});
    EXPECT_TRUE(found.converged) << name;
    EXPECT_LT(displacement(mesh, found.transform * motion), 5e-4 * size) << name;
    EXPECT_GT(found.fraction_used, 0.93) << name;
    EXPECT_LT(found.fraction_used, 0.999) << name;
    EXPECT_LT(found.after.trimmed_rms, deviation) << name;
    EXPECT_GT(found.after.trimmed_rms, 0.3 * deviation) << name;
    EXPECT_GT(found.after.rms, 2 * found.after.trimmed_rms) << name;
    EXPECT_LT(found.freedoms[5].standard_error, 1e-4 * size) << name;
    EXPECT_GT(found.freedoms[5].standard_error, 1e-7 * size) << name;
  }
}

// A dent moves the pose by less than if its distances were averaged over the surface.
TEST(Align, ADentDoesNotMoveTheRest) {
  const Mesh mesh = load("head.off");
  const double size = size_of(mesh);
  Mesh dented = mesh;
  const Vec3 centre = mesh.positions[100];
  for (Vec3& p : dented.positions)
    if (const double d = norm(p - centre) / (0.1 * size); d < 1) p[2] -= 0.02 * size * (1 - d * d);
  const Transform motion = small_motion(mesh);
  const Alignment found = align(image(dented, motion), Sites(mesh), {.samples = kSamples});
  EXPECT_LT(displacement(mesh, found.transform * motion), 1e-9 * size);
}

// Most of the area is plane and has no residual, so that all others seem to be outliers; but only those
// determine the motion in the plane.
TEST(Align, KeepsTheSamplesThatDetermineTheMotion) {
  Mesh plate = cube(1);
  for (Vec3& p : plate.positions) p[2] *= 0.02;
  std::mt19937 random(7);
  const Transform motion = small_motion(plate);
  const Alignment found = align(image(plate, motion), Sites(plate));
  EXPECT_LT(displacement(plate, found.transform * motion), 1e-9);
  EXPECT_EQ(free_count(found), 0u);
  EXPECT_LT(found.freedoms[5].determined, 0.2);
}

/// A plate of squares on both sides, and on its rim, which has 2 % of the area.
Mesh thin_plate(std::uint32_t n) {
  Mesh mesh;
  const auto vertex = [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return (z * (n + 1) + y) * (n + 1) + x;
  };
  for (const double z : {0.0, 0.01})
    for (std::uint32_t y = 0; y <= n; ++y)
      for (std::uint32_t x = 0; x <= n; ++x) mesh.positions.push_back({1.0 * x / n, 1.0 * y / n, z});
  const auto square = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      square(vertex(i, j, 1), vertex(i + 1, j, 1), vertex(i + 1, j + 1, 1), vertex(i, j + 1, 1));
      square(vertex(i, j, 0), vertex(i, j + 1, 0), vertex(i + 1, j + 1, 0), vertex(i + 1, j, 0));
    }
    square(vertex(i, 0, 0), vertex(i + 1, 0, 0), vertex(i + 1, 0, 1), vertex(i, 0, 1));
    square(vertex(i + 1, n, 0), vertex(i, n, 0), vertex(i, n, 1), vertex(i + 1, n, 1));
    square(vertex(0, i + 1, 0), vertex(0, i, 0), vertex(0, i, 1), vertex(0, i + 1, 1));
    square(vertex(n, i, 0), vertex(n, i + 1, 0), vertex(n, i + 1, 1), vertex(n, i, 1));
  }
  return mesh;
}

// A motion along an axis in the plane moves the hundredth of the area that faces this way along its normals.
TEST(Align, TheFreedomsOfAPlateDoNotDependOnItsTriangles) {
  for (const std::uint32_t n : {1, 2, 8, 10, 32, 50}) {
    SCOPED_TRACE(n);
    Mesh plate = thin_plate(n);
    std::mt19937 random(n);
    for (int order = 0; order < 3; ++order) {
      const Alignment found = align(plate, Sites(plate));
      EXPECT_EQ(free_count(found), 0u) << order;
      for (const DegreeOfFreedom& f : found.freedoms) EXPECT_GT(f.determined, 0.06) << order;
      std::ranges::shuffle(plate.triangles, random);
    }
  }
}

TEST(ParseFreedoms, ReadsLists) {
  const auto parsed = parse_freedoms("xyz,rz");
  ASSERT_TRUE(parsed);
  EXPECT_EQ(parsed->translations, (std::array{true, true, true}));
  EXPECT_EQ(parsed->rotations, (std::array{false, false, true}));
  EXPECT_EQ(parsed->about, Vec3{});
  EXPECT_TRUE(parse_freedoms("x,y,z,rxyz")->all());
  EXPECT_TRUE(parse_freedoms("rx,y"));
  for (const char* text : {"", ",", "x,", ",x", "x,,y", "r", "xr", "X", "w", "rr", "x y"})
    EXPECT_FALSE(parse_freedoms(text)) << text;
}

TEST(Align, PrincipalAxesNeedNoStart) {
  for (const char* name : {"head.off", "elephant.off", "bracket"}) {
    const Mesh mesh = name == std::string("bracket") ? bracket() : load(name);
    const double size = size_of(mesh);
    const Transform motion =
        Transform::translation({3 * size, -size, 2 * size}) * Transform::rotation({40, 110, -70});
    const Alignment found =
        align(image(mesh, motion), Sites(mesh), {.start = AlignStart::principal_axes, .samples = kSamples});
    EXPECT_LT(displacement(mesh, found.transform * motion), 1e-9 * size) << name;
  }
}

// A nearly square part that is its own mirror image: it nearly fits where it is turned by 90°.
TEST(Align, TriesThePrincipalAxesOfAPoorFit) {
  Mesh plate = cube(1);
  for (Vec3& p : plate.positions) p = {20 * p[0], 19.5 * p[1], 3 * p[2]};
  plate = joined(plate, ring(24, 2, {14, 0, 3}));
  const Sites sites(plate);
  for (const Vec3 turn : {Vec3{0, 0, 33}, {0, 0, 90}, {0, 0, 180}, {40, 100, -70}}) {
    SCOPED_TRACE(turn[0] + turn[2]);
    const Transform motion = Transform::translation({1, 2, -3}) * Transform::rotation(turn);
    const Mesh turned = image(plate, motion);
    const Alignment found = align(turned, sites, {.samples = kSamples});
    EXPECT_LT(displacement(plate, found.transform * motion), 1e-6);
    EXPECT_FALSE(find_mirrored(turned, sites, found));
    const Alignment pose = align(turned, sites, {.start = AlignStart::pose, .samples = kSamples});
    EXPECT_EQ(displacement(plate, pose.transform * motion) > 1, norm(turn) > 45) << "from where it is";
    EXPECT_FALSE(find_mirrored(turned, sites, pose)) << "it fits as it is, elsewhere";
  }
}

TEST(Align, PrincipalAxesOfAPart) {
  const Mesh mesh = load("elephant.off");
  const double size = size_of(mesh);
  const Transform motion =
      Transform::translation({3 * size, -size, 2 * size}) * Transform::rotation({40, 110, -70});
  const Mesh part = image(cut(mesh, 0.3, {0.3, 0.5, 0.8}), motion);
  const Alignment found =
      align(part, Sites(mesh), {.start = AlignStart::principal_axes, .samples = kSamples});
  EXPECT_LT(displacement(mesh, found.transform * motion), 1e-9 * size);
}

TEST(Align, StartsAtAPose) {
  const Mesh mesh = bracket();
  const Transform motion = Transform::translation({20, 5, 1}) * Transform::rotation({0, 0, 170});
  const Transform start = Transform::rotation({0, 0, -172}) * Transform::translation({-20.05, -5, -1});
  const Alignment found = align(image(mesh, motion), Sites(mesh), {.pose = start, .samples = kSamples});
  EXPECT_LT(displacement(mesh, found.transform * motion), 1e-9);
}

// As the samples move along with O1.
TEST(Align, AMotionOfO1ChangesTheResultAccordingly) {
  const Mesh mesh = load("head.off");
  std::mt19937 random(3);
  const double size = size_of(mesh);
  const Mesh scan = with_noise(cut(mesh, 0.2, {1, 0, 0}), 5e-4 * size, random);
  const Sites sites(mesh);
  const Transform motion = small_motion(mesh);
  const Alignment found = align(scan, sites, {.samples = kSamples});
  const Alignment moved = align(image(scan, motion), sites, {.samples = kSamples});
  EXPECT_LT(displacement(mesh, moved.transform * motion * Transform(found.transform)), 2e-3 * size);
  for (const Vec3& p : {Vec3{}, Vec3{size, 0, 0}, Vec3{0, size, size}})
    EXPECT_LT(norm((moved.transform * motion)(p)-found.transform(p)), 1e-5 * size);
}

TEST(Align, DoesNotDependOnTheNumberOfThreads) {
  std::mt19937 random(4);
  const Mesh mesh = bracket();
  const Sites sites(mesh);
  const Mesh scan = image(with_outliers(with_noise(mesh, 0.002, random), random), small_motion(mesh));
  const Alignment all = align(scan, sites, {.samples = kSamples});
  const ThreadLimit limit(1);
  const Alignment one = align(scan, sites, {.samples = kSamples});
  EXPECT_EQ(one.transform.rows, all.transform.rows);
  EXPECT_EQ(one.iterations, all.iterations);
  EXPECT_EQ(one.after.rms, all.after.rms);
  for (int k = 0; k < 6; ++k) EXPECT_EQ(one.freedoms[k].determined, all.freedoms[k].determined);
}

// The free motions of a plane: two translations in it and the rotation about its normal.
TEST(AlignFreedoms, OfAPlane) {
  Mesh mesh = square(2, 0);
  const Alignment found = align(image(mesh, small_motion(mesh)), Sites(mesh), {.samples = kSamples});
  ASSERT_EQ(free_count(found), 3u);
  EXPECT_TRUE(found.converged);
  EXPECT_LT(found.after.trimmed_rms, 1e-12);
  int rotations = 0;
  for (const DegreeOfFreedom& f : std::span(found.freedoms).last(3)) {
    EXPECT_TRUE(f.free);
    EXPECT_LT(f.determined, 1e-6);
    EXPECT_EQ(f.standard_error, std::nullopt);
    EXPECT_LT(std::abs(f.translation[2]), 1e-6);
    if (norm(f.rotation) < 0.5) continue;
    ++rotations;
    EXPECT_NEAR(std::abs(f.rotation[2]), 1, 1e-6);
  }
  EXPECT_EQ(rotations, 1);
}

TEST(AlignFreedoms, OfASphere) {
  for (const int levels : {2, 3, 4}) {
    const Mesh mesh = moved(sphere(levels), {10, 20, 30});
    const Alignment found = align(image(mesh, small_motion(mesh)), Sites(mesh), {.samples = kSamples});
    ASSERT_EQ(free_count(found), 3u) << levels;
    for (const DegreeOfFreedom& f : std::span(found.freedoms).last(3)) {
      EXPECT_GT(norm(f.rotation), 0.99);
      EXPECT_LT(norm(f.axis_point.value() - Vec3{10, 20, 30}), 0.05);
    }
    // What is free stays: the motion is a translation.
    EXPECT_NEAR(found.transform.rows[0][0], 1, 1e-4);
    EXPECT_NEAR(found.transform.rows[1][1], 1, 1e-4);
  }
}

/// A tube without ends, around the z axis.
Mesh tube(std::uint32_t sides) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < sides; ++i) {
    const double angle = 2 * std::numbers::pi * i / sides;
    for (const double z : {-2.0, 2.0}) mesh.positions.push_back({std::cos(angle), std::sin(angle), z});
    const std::uint32_t a = 2 * i, c = 2 * ((i + 1) % sides);
    mesh.triangles.push_back({a, c, a + 1});
    mesh.triangles.push_back({a + 1, c, c + 1});
  }
  return mesh;
}

TEST(AlignFreedoms, OfACylinder) {
  const Mesh mesh = moved(tube(40), {5, 6, 7});
  const Alignment found = align(image(mesh, small_motion(mesh)), Sites(mesh), {.samples = kSamples});
  ASSERT_EQ(free_count(found), 2u);
  int translations = 0, rotations = 0;
  for (const DegreeOfFreedom& f : std::span(found.freedoms).last(2)) {
    const bool turns = norm(f.rotation) > 0.5;
    (turns ? rotations : translations)++;
    EXPECT_NEAR(std::abs((turns ? f.rotation : f.translation)[2]), 1, 1e-3);
    if (turns) {
      EXPECT_LT(std::hypot(f.axis_point.value()[0] - 5, f.axis_point.value()[1] - 6), 1e-2);
    }
  }
  EXPECT_EQ(translations, 1);
  EXPECT_EQ(rotations, 1);
}

TEST(AlignFreedoms, OfATorus) {
  const Mesh mesh = torus(64, 48);
  const Alignment found = align(mesh, Sites(mesh), {.samples = kSamples});
  ASSERT_EQ(free_count(found), 1u);
  EXPECT_GT(norm(found.freedoms[5].rotation), 0.99);
}

TEST(AlignPoints, OfACloud) {
  const Mesh mesh = load("head.off");
  std::mt19937 random(9);
  const Transform motion = small_motion(mesh);
  std::vector<Vec3> points = random_surface_points(mesh, 20000, random);
  for (std::size_t i = 0; i < points.size(); i += 100) points[i] = random_point(bounds(mesh), random);
  transform(points, motion);
  const Sites sites(mesh);
  const Alignment found = align(points, {}, sites, {.samples = kSamples});
  EXPECT_TRUE(found.converged);
  EXPECT_EQ(found.samples, kSamples);
  EXPECT_LT(displacement(mesh, found.transform * motion), 1e-9 * size_of(mesh));
  points.resize(3000);
  const Alignment all = align(points, {}, sites);
  EXPECT_EQ(all.samples, 3000u);
  EXPECT_LT(displacement(mesh, all.transform * motion), 1e-9 * size_of(mesh));
}

// With normals, the two walls of a sheet cannot be confused.
TEST(AlignPoints, NormalsTellTheSidesOfASheetApart) {
  Mesh sheet = height_field(40);
  const double thickness = 0.01 * size_of(sheet);
  sheet.corner_uvs.clear();
  const Mesh solid = joined(sheet, moved(flipped(sheet), {0, 0, -thickness}));
  std::mt19937 random(2);
  const Transform motion = Transform::translation({0, 0, -0.9 * thickness});
  const Alignment found = align(image(solid, motion), Sites(solid), {.samples = kSamples});
  EXPECT_LT(displacement(solid, found.transform * motion), 1e-9 * size_of(solid));
}

TEST(AlignErrors, NameTheFault) {
  const Mesh mesh = cube();
  const Sites sites(mesh);
  EXPECT_THAT(error_of([&] { return align(mesh, sites, {.pose = Transform::scaling(2)}); }),
              HasSubstr("not a rotation and a translation"));
  EXPECT_THAT(error_of([&] { return align(mesh, sites, {.pose = Transform::scaling(-1)}); }),
              HasSubstr("not a rotation and a translation"));
  EXPECT_THAT(error_of([&] { return align(mesh, sites, {.samples = 3}); }),
              HasSubstr("samples is 3: it must be"));
  EXPECT_THAT(error_of([&] { return align(mesh, sites, {.max_iterations = 0}); }),
              HasSubstr("max_iterations is 0"));
  EXPECT_THAT(error_of([&] { return align(std::span<const Vec3>(), {}, sites); }), HasSubstr("needs points"));
  const std::vector<Vec3> points{{0, 0, 0}, {1, std::numeric_limits<double>::quiet_NaN(), 0}};
  EXPECT_THAT(error_of([&] { return align(points, {}, sites); }), HasSubstr("point 1 has a coordinate"));
  EXPECT_THAT(error_of([&] { return align(points, std::span(points).first(1), sites); }),
              HasSubstr("one normal for each point"));
  EXPECT_THROW((void)align(Mesh{}, sites), Error);
  EXPECT_THROW((void)align(mesh, sites, {.progress = [](std::string_view, double) { return false; }}),
               Cancelled);
}

// Coordinates in single precision, as in STL, are no outliers, however few faces have them exactly.
TEST(Align, RoundedCoordinatesFit) {
  for (const auto& [name, mesh] : bodies()) {
    Mesh copy = image(mesh, small_motion(mesh));
    for (Vec3& p : copy.positions)
      for (double& x : p) x = static_cast<float>(x);
    const Alignment found = align(copy, Sites(mesh), {.samples = kSamples});
    EXPECT_EQ(found.fraction_fitting, 1) << name;
    EXPECT_LE(found.fraction_used, 1) << name;
  }
}

/// Every face divided into four, `times` times, with vertices of its own.
Mesh subdivided(Mesh mesh, int times) {
  for (; times > 0; --times) {
    Mesh finer;
    for (const Triangle& t : mesh.triangles) {
      const auto first = static_cast<std::uint32_t>(finer.positions.size());
      for (int k = 0; k < 3; ++k) finer.positions.push_back(mesh.positions[t[k]]);
      for (int k = 0; k < 3; ++k)
        finer.positions.push_back(0.5 * (mesh.positions[t[k]] + mesh.positions[t[(k + 1) % 3]]));
      for (const Triangle& u : {Triangle{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}})
        finer.triangles.push_back({first + u[0], first + u[1], first + u[2]});
    }
    mesh = finer;
  }
  return mesh;
}

TEST(AlignRegion, OnlyTheRegionCounts) {
  const Mesh mesh = bracket();
  const double size = size_of(mesh);
  // Half of O1, x < 0, is bent away by 1 % of the size: no fit of all of it is one of the other half.
  Mesh bent = subdivided(mesh, 4);
  for (Vec3& p : bent.positions)
    if (p[0] < 0) p[2] += 0.01 * size * p[0] * p[0] / 9;
  const Box half{{0.01, -10, -10}, {10, 10, 10}};
  const Transform motion = small_motion(mesh);
  const Sites sites(mesh);
  const Mesh o1 = image(bent, motion);
  const Alignment part = align(o1, sites, {.region = {.boxes = {half}}});
  EXPECT_LT(displacement(mesh, part.transform * motion), 1e-9 * size);
  EXPECT_LT(part.after.rms, 1e-9 * size);
  EXPECT_LT(part.samples, 32768u);
  const Alignment whole = align(o1, sites);
  EXPECT_GT(displacement(mesh, whole.transform * motion), 1e-6 * size);

  std::vector<std::uint8_t> faces;
  for (const Triangle& t : mesh.triangles) {
    double least = 10;
    for (const std::uint32_t v : t) least = std::min(least, mesh.positions[v][0]);
    faces.push_back(least > 0.01);
  }
  const Alignment by_faces = align(o1, sites, {.region = {.faces = faces}});
  EXPECT_LT(by_faces.samples, part.samples);
  EXPECT_LT(displacement(mesh, by_faces.transform * motion), 1e-9 * size);
}

TEST(AlignRegion, FaultsAreNamed) {
  const Mesh mesh = cube();
  const Sites sites(mesh);
  EXPECT_THAT(error_of([&] {
                return align(mesh, sites, {.region = {.faces = {1, 1}}});
              }),
              HasSubstr("an entry for each face of O2"));
  EXPECT_THAT(error_of([&] { return align(mesh, sites, {.region = {.boxes = {Box{}}}}); }),
              HasSubstr("is empty"));
  EXPECT_THAT(error_of([&] {
                return align(mesh, sites, {.region = {.boxes = {Box{{9, 9, 9}, {9, 9, 9}}}}});
              }),
              HasSubstr("no part of O1 is near the region"));
  const std::vector<std::uint32_t> groups{0};
  EXPECT_THAT(error_of([&] { return align(mesh, sites, {.group_of_face = groups}); }),
              HasSubstr("an entry for each face of O2"));
}

TEST(AlignGroups, ResidualsAreThoseOfTheFacesOfAGroup) {
  Mesh mesh = cube(1);
  Mesh dented = subdivided(mesh, 3);
  for (Vec3& p : dented.positions)
    if (p[2] > 0.999 && std::abs(p[0]) < 0.9 && std::abs(p[1]) < 0.9) p[2] -= 0.02;
  std::vector<std::uint32_t> group;
  for (const Triangle& t : mesh.triangles) {
    const auto high = [&](std::uint32_t v) { return mesh.positions[v][2] > 0.999; };
    group.push_back(std::ranges::all_of(t, high) ? 1 : 0);
  }
  group[0] = group[0] == 1 ? 1 : kNone;
  const Alignment found = align(dented, Sites(mesh), {.group_of_face = group});
  ASSERT_EQ(found.groups.size(), 2u);
  EXPECT_NEAR(found.groups[1].largest, 0.02, 1e-6);
  EXPECT_GT(found.groups[1].rms, 0.005);
  EXPECT_LT(found.groups[1].rms, found.groups[1].largest);
  EXPECT_LT(found.groups[0].rms, 1e-3);
  EXPECT_GT(found.groups[0].samples, found.groups[1].samples);
  EXPECT_LT(found.groups[0].samples + found.groups[1].samples, found.samples);
}

/// The rotation by a vector, in radians.
Transform rotation_by(const Vec3& v) {
  const double angle = norm(v), half = angle / 2;
  const double s = angle > 0 ? std::sin(half) / angle : 0;
  return Transform::quaternion({std::cos(half), s * v[0], s * v[1], s * v[2]});
}

// A displacement by the free motions is undone; none of the others is used.
TEST(AlignFreedomsLocked, UndoesADisplacementByFreeMotionsOnly) {
  const Mesh mesh = bracket();
  const Sites sites(mesh);
  const Vec3 about{0.4, -0.3, 0.2};
  for (int mask = 0; mask < 64; ++mask) {
    AlignFreedoms freedoms{.about = about};
    Vec3 shift{}, turn{};
    const Vec3 shifts{0.05, -0.04, 0.03}, turns{0.03, 0.05, -0.04};
    for (int k = 0; k < 3; ++k) {
      if (freedoms.translations[k] = (mask >> k & 1) != 0; freedoms.translations[k]) shift[k] = shifts[k];
      if (freedoms.rotations[k] = (mask >> (k + 3) & 1) != 0; freedoms.rotations[k]) turn[k] = turns[k];
    }
    // The motion to be found is of the form that AlignFreedoms states, so O1 is moved by its inverse.
    const Transform sought =
        Transform::translation(about + shift) * rotation_by(turn) * Transform::translation(-about);
    const Transform back =
        Transform::translation(about) * rotation_by(-turn) * Transform::translation(-about - shift);
    const Alignment found = align(image(mesh, back), sites, {.samples = 2048, .freedoms = freedoms});
    EXPECT_TRUE(found.converged) << mask;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 4; ++j)
        EXPECT_NEAR(found.transform.rows[i][j], sought.rows[i][j], 1e-9) << mask << " " << i << j;
    EXPECT_EQ(std::ranges::count(found.freedoms, true, &DegreeOfFreedom::locked),
              6 - std::popcount(unsigned(mask)));
    EXPECT_EQ(free_count(found), 0u) << mask;
  }
}

// What is locked is exactly as before, however O1 is displaced.
TEST(AlignFreedomsLocked, LeavesWhatIsLocked) {
  const Mesh mesh = bracket();
  const Mesh o1 = image(mesh, small_motion(mesh));
  AlignFreedoms freedoms{.translations = {true, true, false}, .rotations = {false, false, true}};
  const Alignment planar = align(o1, Sites(mesh), {.samples = kSamples, .freedoms = freedoms});
  EXPECT_EQ(planar.transform.rows[2], (std::array<double, 4>{0, 0, 1, 0}));
  EXPECT_GT(std::abs(planar.transform.rows[0][1]), 1e-3);
  EXPECT_LT(planar.after.rms, planar.before.rms);
  EXPECT_GT(planar.after.rms, 1e-3 * size_of(mesh));
  const Alignment none = align(
      o1, Sites(mesh), {.samples = kSamples, .freedoms = {{false, false, false}, {false, false, false}}});
  EXPECT_EQ(none.transform.rows, Transform{}.rows);
  EXPECT_TRUE(none.converged);
  EXPECT_NEAR(none.after.rms, none.before.rms, 0.1 * none.before.rms);
  EXPECT_THAT(error_of([&] {
                return align(o1, Sites(mesh), {.start = AlignStart::principal_axes, .freedoms = freedoms});
              }),
              HasSubstr("locked"));
}

// A shaft may turn about its axis without a doubt, if that was locked.
TEST(AlignFreedomsLocked, WhatO2DoesNotDetermineIsStillFree) {
  const Mesh mesh = torus(64, 48);
  const auto free_of = [&](const AlignFreedoms& freedoms) {
    return free_count(align(mesh, Sites(mesh), {.samples = kSamples, .freedoms = freedoms}));
  };
  EXPECT_EQ(free_of({.rotations = {true, false, false}}) + free_of({.rotations = {false, true, false}}) +
                free_of({.rotations = {false, false, true}}),
            1u);
}

TEST(Align321, FindsThePoseOfSixPoints) {
  const std::vector<Vec3> places{{0, 0, 5}, {10, 1, 5}, {2, 8, 5}, {1, 0, 2}, {9, 0, 3}, {0, 4, 1}};
  const Transform motion = Transform::translation({1e5, -2e5, 300}) * Transform::rotation({30, 100, -50});
  std::vector<Vec3> points = places;
  for (Vec3& p : points) p = motion(p);
  const Transform found = align_321(points, places);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_LT(norm(found(points[i]) - places[i]), 1e-9);
  EXPECT_NEAR(found.determinant(), 1, 1e-14);
}

// Each point gives up only the directions that its datum determines.
TEST(Align321, UsesPlaneThenLineThenPoint) {
  const std::vector<Vec3> places{{0, 0, 0}, {10, 0, 0}, {0, 10, 0}, {0, 0, 2}, {10, 0, 3}, {0, 5, 1}};
  std::vector<Vec3> points = places;
  points[1] += Vec3{0.3, -0.2, 0};  // in the plane
  points[3] += Vec3{0.4, 0, -0.7};  // along the line, and along the normal
  points[5] += Vec3{0, 0.5, -0.2};  // across the line
  const Transform found = align_321(points, places);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j) EXPECT_NEAR(found.rows[i][j], i == j ? 1 : 0, 1e-14);
  points[5][0] += 0.25;
  EXPECT_NEAR(align_321(points, places).rows[0][3], -0.25, 1e-14);
}

TEST(Align321, FaultsAreNamed) {
  const std::vector<Vec3> good{{0, 0, 0}, {10, 0, 0}, {0, 10, 0}, {0, 0, 2}, {10, 0, 3}, {0, 5, 1}};
  std::vector<Vec3> bad = good;
  EXPECT_THAT(error_of([&] { return align_321(std::span(good).first(5), good); }), HasSubstr("six points"));
  bad[2] = {20, 0, 0};
  EXPECT_THAT(error_of([&] { return align_321(bad, good); }),
              HasSubstr("primary points of O1 are on a line"));
  bad = good;
  bad[4] = {0, 0, 9};
  EXPECT_THAT(error_of([&] { return align_321(good, bad); }), HasSubstr("secondary points on O2"));
  bad = good;
  bad[4][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(error_of([&] { return align_321(good, bad); }), HasSubstr("NaN"));
}

// A few points, or all in one place, determine little; none of it is an error.
TEST(AlignErrors, FewPointsAreNone) {
  const Sites sites(cube());
  for (const std::vector<Vec3>& points :
       {std::vector<Vec3>{{0.3, 0.2, 1.1}}, {{0.3, 0.2, 1.1}, {0.3, 0.2, 1.1}}, {{5, 5, 5}, {-5, 0, 0}}}) {
    const Alignment found = align(points, {}, sites);
    EXPECT_TRUE(std::isfinite(found.transform.rows[0][3]));
    EXPECT_NEAR(found.transform.determinant(), 1, 1e-12);
    EXPECT_GT(free_count(found), 0u);
  }
}

TEST(AlignErrors, FarPointsAreNone) {
  const Sites sites(cube());
  for (const double far : {1e9, 1e20, 1e37}) {
    const Alignment found = align(std::vector<Vec3>{{far, 0, 0}, {far, far, 0}, {0, far, -far}}, {}, sites);
    for (const auto& row : found.transform.rows)
      for (const double x : row) EXPECT_TRUE(std::isfinite(x)) << far;
    EXPECT_NEAR(found.transform.determinant(), 1, 1e-12);
    EXPECT_TRUE(std::isfinite(found.before.rms)) << far;
  }
}

// A part in the wrong unit is so far from O2 that steps lead away from it.
TEST(Align, NeverEndsFartherAwayThanItBegan) {
  const Mesh o2 = placed(torus(24, 12), "rotate:10:20:30");
  const Sites sites(o2);
  for (const char* placement : {"scale:1000", "scale:30", "scale:0.001"}) {
    SCOPED_TRACE(placement);
    const Alignment found = align(placed(o2, placement), sites);
    EXPECT_LE(found.after.trimmed_rms, 1.05 * found.before.trimmed_rms) << "`before` is of fewer samples";
  }
  EXPECT_LE(align(placed(o2, "scale:1000"), sites).iterations, 100) << "of the first level only";
}

}  // namespace
}  // namespace sdm
