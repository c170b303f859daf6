#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/execution.h>
#include <sdm/map_files.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "io/image/pictures/face_scales.h"
#include "io/image/views/render_view.h"
#include "io/image/views/view_layout.h"
#include "io_write/read_png.h"
#include "support/made_up_maps.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace sdm::test {
namespace {

using namespace io;

Projection looking_down(std::uint32_t width, std::uint32_t height, double scale) {
  return {.centre = {0.5, 0.5, 0.5}, .scale = scale, .width = width, .height = height};
}

/// The depth of a face on the line through (x, y) along z; −∞ if it misses by more than `margin`, +∞ if it
/// passes an edge more closely.
double depth_at(const Mesh& mesh, const Triangle& t, double x, double y, double margin) {
  const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
  const double area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  const double u = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / area;
  const double v = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area;
  const double inside = std::min({u, v, 1 - u - v});
  if (!(std::abs(inside) > margin)) return kInfinity;
  return inside < 0 ? -kInfinity : a[2] + u * (b[2] - a[2]) + v * (c[2] - a[2]);
}

TEST(DepthBuffer, FindsTheNearestFaceOfEverySample) {
  std::mt19937 random(3);
  const Mesh mesh = soup(300, random);
  const Projection projection = looking_down(61, 47, 40);
  const DepthBuffer buffer(mesh, projection);
  std::size_t compared = 0;
  for (std::uint32_t row = 0; row < buffer.height(); ++row)
    for (std::uint32_t column = 0; column < buffer.width(); ++column) {
      const double x = 0.5 + ((column + 0.5) / DepthBuffer::kSamples - 0.5 * projection.width) / 40;
      const double y = 0.5 - ((row + 0.5) / DepthBuffer::kSamples - 0.5 * projection.height) / 40;
      double nearest = -kInfinity;
      for (const Triangle& t : mesh.triangles) nearest = std::max(nearest, depth_at(mesh, t, x, y, 1e-4));
      if (nearest == kInfinity) continue;  // at an edge
      const auto [depth_seen, face] = buffer.seen(column, row);
      if (nearest == -kInfinity) {
        ASSERT_EQ(face, kNone);
        continue;
      }
      ASSERT_NEAR(depth_seen, nearest - 0.5, 1e-4) << row << ' ' << column;
      const Vec3 weights = buffer.point({column + 0.5, row + 0.5}, mesh.triangles[face]).weights;
      double depth = 0;
      for (int k = 0; k < 3; ++k) depth += weights[k] * mesh.positions[mesh.triangles[face][k]][2];
      ASSERT_NEAR(depth, nearest, 1e-4);
      ++compared;
    }
  EXPECT_GT(compared, 500u);
}

// Faces that are seen from the back are drawn after the others, where these do not hide them.
TEST(DepthBuffer, SeesTheSameFromTheBack) {
  std::mt19937 random(4);
  Mesh mesh = soup(300, random);
  const std::size_t count = mesh.triangles.size();
  for (std::size_t face = 0; face < count; ++face) mesh.triangles.push_back(mesh.triangles[face]);
  const Projection projection = looking_down(61, 47, 40);
  const DepthBuffer buffer(mesh, projection);
  for (const auto& turns : {std::function([](std::size_t) { return true; }),
                            std::function([](std::size_t face) { return face % 3 == 0; }),
                            std::function([=](std::size_t face) { return face < count; })}) {
    Mesh turned = mesh;
    for (std::size_t face = 0; face < turned.triangles.size(); ++face)
      if (turns(face)) std::swap(turned.triangles[face][1], turned.triangles[face][2]);
    const DepthBuffer other(turned, projection);
    for (std::uint32_t row = 0; row < buffer.height(); ++row)
      for (std::uint32_t column = 0; column < buffer.width(); ++column) {
        const auto [depth, face] = buffer.seen(column, row);
        ASSERT_EQ(other.seen(column, row).face, face);  // the first of two in the same place
        ASSERT_EQ(other.seen(column, row).depth, depth);
        ASSERT_TRUE(face == kNone || face < count);
      }
  }
}

TEST(DepthBuffer, HasNoHolesBetweenFaces) {
  const Mesh mesh = sphere(5);  // 20,480 faces, smaller than a sample
  Projection projection = looking_down(80, 80, 30);
  projection.centre = {};
  const DepthBuffer buffer(mesh, projection);
  for (std::uint32_t row = 0; row < buffer.height(); ++row)
    for (std::uint32_t column = 0; column < buffer.width(); ++column) {
      const double x = ((column + 0.5) / 2 - 40) / 30, y = ((row + 0.5) / 2 - 40) / 30, r = std::hypot(x, y);
      const std::uint32_t face = buffer.seen(column, row).face;
      ASSERT_TRUE(r > 0.99 || face != kNone);
      ASSERT_TRUE(r <= 1 || face == kNone);
    }
}

TEST(ShadingNormals, AreThoseOfThePresentShape) {
  Surface surface(cube(), {.resolution = 128});
  const auto before = shading_normals(surface).normals;
  std::vector<Vec3> sheared = surface.mesh().positions;
  for (Vec3& p : sheared) p[0] += p[1];
  surface.refit(sheared);
  const auto refitted = shading_normals(surface).normals;
  EXPECT_NE(refitted, before);
  EXPECT_EQ(refitted, shading_normals(surface.mesh()).normals);
  surface.edit({.removed_faces = {0}});
  EXPECT_EQ(shading_normals(surface).corner, shading_normals(surface.mesh()).corner);
  EXPECT_EQ(shading_normals(surface).corner[0][0], kNone);
}

TEST(ViewLayout, PlacesTheBoxInEveryCell) {
  for (const UpAxis up : {UpAxis::y, UpAxis::z})
    for (const Vec3& size :
         {Vec3{1, 1, 1}, Vec3{100, 1, 1}, Vec3{1, 100, 2}, Vec3{1, 3, 0}, Vec3{2e30, 1e30, 0}}) {
      const Box box{{5, -7, 2}, Vec3{5, -7, 2} + size};
      const ViewLayout layout = layout_views(box, up);
      EXPECT_LE(layout.width, 2600u);
      EXPECT_LE(layout.height, 1400u);
      for (const PlacedView& view : layout.views) {
        EXPECT_NEAR(norm(cross(view.projection.right, view.projection.up) - view.projection.towards), 0, 0);
        for (int corner = 0; corner < 8; ++corner) {
          Vec3 point;
          for (int k = 0; k < 3; ++k) point[k] = corner >> k & 1 ? box.upper[k] : box.lower[k];
          const Vec3 at = view.projection(point);
          EXPECT_GE(at[0], 0);
          EXPECT_LE(at[0], view.projection.width);
          EXPECT_GE(at[1], kViewTitle);
          EXPECT_LE(at[1], view.projection.height);
        }
        EXPECT_LE(view.x + view.projection.width, layout.width);
        EXPECT_LE(view.y + view.projection.height, layout.height);
      }
    }
}

TEST(ViewLayout, ShowsWhatIsNearOfTheOtherMesh) {
  const Box part{{0, 0, 0}, {1, 1, 1}};
  const Box shown = shown_box(part, {{-1e9, 0.5, 0.4}, {0.5, 1.1, 0.6}});
  EXPECT_DOUBLE_EQ(shown.lower[0], -0.5 * std::sqrt(3));
  EXPECT_EQ(shown.upper, (Vec3{1, 1.1, 1}));
  EXPECT_EQ(shown.lower[1], 0);
}

/// Of a cube, distance and colour grow along x; of O2, a cube behind it, the part beside it is seen.
struct CubeScene {
  Surface surface{cube(), {.resolution = 256}};
  Field field = [](const Vec3& p) { return p[0]; };
  DistanceMap map = map_of(surface, field);
  std::vector<float> vertices = at_vertices(surface.mesh(), field);
};

/// Whether red outweighs blue, as above 0 in the diverging colormap.
double redness(Rgb color) {
  return static_cast<double>(color.r) - color.b;
}

TEST(Views, ShowEachSideAsItIsSeen) {
  const CubeScene scene;
  const TemporaryFolder folder;
  for (const UpAxis up : {UpAxis::y, UpAxis::z}) {
    const PictureOptions options{.colormap = Colormap::diverging, .range = {{-1, 1}}, .up = up};
    write_views_png(folder / "views.png", scene.surface, scene.map, scene.vertices, nullptr, options);
    const Pixels pixels = read_png(folder / "views.png");
    const ViewLayout layout = layout_views(bounds(scene.surface.mesh()), up);
    // Along x from left to right: front, top and bottom; from right to left: back; the sides are one colour.
    constexpr std::array<double, 6> kTowardsRight{1, 0, 1, -1, 0, 1}, kSide{0, -1, 0, 0, 1, 0};
    for (int i = 0; i < 6; ++i) {
      const PlacedView& view = layout.views[i];
      const Vec3 middle = view.projection(Vec3{});
      const double half = 0.7 * layout.scale;
      const auto at = [&](double x) {
        return redness(
            pixels.at(std::size_t(view.x + middle[0] + x), std::size_t(view.y + middle[1] + half)));
      };
      EXPECT_GT(kTowardsRight[i] * (at(half) - at(-half)), kTowardsRight[i] == 0 ? -1 : 100) << view.name;
      EXPECT_GT(kSide[i] * at(half), kSide[i] == 0 ? -1 : 20) << view.name;
    }
  }
}

TEST(Views, ShowTheOtherMeshPaleAndMarkVisiblePlaces) {
  const CubeScene cube_scene;
  const Mesh other = moved(cube(), {0.5, 0, -3});  // behind the cube in the front view, and to the right
  const std::vector<float> distances(cube_scene.map.texels(), 0);
  const FaceScales red({.map = Colormap::paper2006}, {});  // at 0
  ViewScene scene{.surface = &cube_scene.surface,
                  .normals = &shading_normals(cube_scene.surface),
                  .distances = distances,
                  .vertex_distances = cube_scene.vertices,
                  .of_faces = &red,
                  .other = &other,
                  .other_normals = shading_normals(other)};
  const Projection front{.scale = 20, .width = 100, .height = 100};
  const std::vector<Vec3> places{{0.2, 0.3, 1}, {0.2, 0.3, -1}};
  const View view = render_view(scene, front, places);
  EXPECT_THAT(view.visible, ::testing::ElementsAre(true, false));
  EXPECT_NEAR(view.in_front[0], 0, 0.1);
  EXPECT_NEAR(view.in_front[1], 2, 0.1);
  const auto at = [&](std::size_t x) { return view.picture.pixels[50 * 100 + x]; };
  EXPECT_GT(redness(at(50)), 150);             // O1
  EXPECT_NEAR(redness(at(75)), 0, 20);         // O2 beside it
  EXPECT_LT(at(75).r, kViewBackground.r - 5);  // which differs from the background
  EXPECT_EQ(at(90), kViewBackground);
  EXPECT_EQ(at(10), kViewBackground);

  const Mesh nearer = moved(other, {0, 0, 6});
  scene.other = &nearer;
  const View veiled = render_view(scene, front, places);
  EXPECT_GT(redness(veiled.picture.pixels[50 * 100 + 55]), 60);  // O1 behind the veil
  EXPECT_LT(redness(veiled.picture.pixels[50 * 100 + 55]), redness(at(55)));
  EXPECT_THAT(veiled.visible, ::testing::ElementsAre(true, false));
}

// Where colours of neighbours differ, a pixel has the mean of its samples; elsewhere, one colour will do.
TEST(Views, SmoothTheEdgesOfColours) {
  const CubeScene cube_scene;
  const DistanceMap step = map_of(cube_scene.surface, [](const Vec3& p) { return p[0] < 0.3 ? -1 : 1; });
  const FaceScales scales({.map = Colormap::diverging, .lower = -1, .upper = 1}, {});
  const ViewScene scene{.surface = &cube_scene.surface,
                        .normals = &shading_normals(cube_scene.surface),
                        .distances = std::span(step.distance).first(step.texels()),
                        .vertex_distances = cube_scene.vertices,
                        .of_faces = &scales};
  const Vec3 right{std::cos(0.3), std::sin(0.3), 0}, up{-std::sin(0.3), std::cos(0.3), 0};
  const Picture picture =
      render_view(scene, {.right = right, .up = up, .scale = 40, .width = 100, .height = 100}, {}).picture;
  const auto at = [&](std::size_t x, std::size_t y) { return redness(picture.pixels[y * 100 + x]); };
  const double blue = at(40, 50), red = at(75, 50);
  int between = 0;
  for (std::size_t y = 30; y < 70; ++y)
    for (std::size_t x = 40; x < 80; ++x) {
      EXPECT_GE(at(x, y), blue - 1);
      EXPECT_LE(at(x, y), red + 1);
      between += at(x, y) > blue + 20 && at(x, y) < red - 20 ? 1 : 0;
    }
  EXPECT_GT(between, 20);
  EXPECT_LT(between, 120);
}

// On a cube inside a cube: the pictures differ by nothing but the mark of the largest distance.
TEST(Views, MarkExtremesThatNoSideShows) {
  const TemporaryFolder folder;
  const Mesh mesh = joined(cube(1), cube(0.5));
  const Surface surface(mesh, {.resolution = 128});
  const auto picture = [&](const Vec3& place) {
    const Field field = [&](const Vec3& p) {
      return p == place ? 2 : std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])}) > 0.9 ? p[0] : 0;
    };
    write_views_png(folder / "views.png", surface, map_of(surface, field), at_vertices(mesh, field), nullptr,
                    {.range = {{-1, 1}}});
    return read_png(folder / "views.png").colors;
  };
  EXPECT_NE(picture({0.5, 0.5, 0.5}), picture({-0.5, -0.5, 0.5}));
}

// A single view has the colours of the sides that it shows, and O2 in its own colours where these are given.
TEST(Views, OneIsSeenFromAnyDirection) {
  const CubeScene scene;
  const TemporaryFolder folder;
  const Mesh other = moved(cube(), {4, 0, 0});
  const std::vector<float> distances(other.positions.size(), 1);
  const PictureOptions options{.colormap = Colormap::diverging, .range = {{-1, 1}}};
  const auto written = [&](const ViewOptions& view) {
    write_view_png(folder / "view.png", scene.surface, scene.map, scene.vertices, view, options);
    return read_png(folder / "view.png");
  };
  // The distance is x: red on the right, blue on the left. The cube fills the middle of the picture.
  const Pixels right = written({.towards = {1, 0, 0}, .width = 400, .height = 300});
  const Pixels left = written({.towards = {-1, 0, 0}, .width = 400, .height = 300});
  EXPECT_GT(redness(right.at(200, 150)), 20);
  EXPECT_LT(redness(left.at(200, 150)), -20);
  // From the front, O2 is a quarter from the right border: pale, or red as the right of the cube.
  ViewOptions both{.towards = {0, 0, 1}, .width = 400, .height = 300, .other = &other};
  EXPECT_LT(std::abs(redness(written(both).at(330, 150))), 20);
  both.other_distances = distances;
  EXPECT_GT(redness(written(both).at(330, 150)), 20);
  // Nothing is cut off: the border is background from any direction.
  for (const Vec3& towards : {Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{1, 1, 1}, Vec3{-3, 0.2, -1}}) {
    both.towards = towards;
    const Pixels pixels = written(both);
    for (std::size_t x = 0; x < 400; ++x) {
      EXPECT_EQ(redness(pixels.at(x, 5)), redness(pixels.at(0, 0)));
      EXPECT_EQ(redness(pixels.at(x, 294)), redness(pixels.at(0, 0)));
    }
  }
  EXPECT_THROW(written({.towards = {0, 0, 0}}), Error);
  EXPECT_THROW(written({.width = 63}), Error);
  EXPECT_THROW(written({.other_distances = distances}), Error);
}

TEST(FaceScales, HaveTheBandsOfTheGroupsOfAFace) {
  const std::vector<FaceNames> names{
      {.kind = "group", .names = {"narrow", "wide"}, .of_face = {0, 1, kNone}}};
  const std::vector<GroupTolerance> table{{"narrow", Tolerance(-1, 1)}, {"wide", Tolerance(-4, 4)}};
  PictureOptions options{.table = table, .names = names};
  const ColorScale scale{.map = Colormap::diverging, .lower = -5, .upper = 5};
  const FaceScales by_group(scale, options);
  EXPECT_EQ(by_group(0, 0.1), kWithin[0]);
  EXPECT_EQ(by_group(0, 1.5), kAbove[1]);
  EXPECT_EQ(by_group(0, -2), kBelow[2]);
  EXPECT_EQ(by_group(1, 1.5), kWithin[1]);
  EXPECT_EQ(by_group(2, 1.5), kUnjudged);
  EXPECT_EQ(by_group(2, std::nan("")), kNoValue);
  options.tolerance = Tolerance(-2, 2);  // of all faces, besides
  const FaceScales both(scale, options);
  EXPECT_EQ(both(1, 3), kAbove[1]);
  EXPECT_EQ(both(2, 1), kWithin[2]);
  EXPECT_EQ(both.of_legend().lower, -2);
  LegendText text{"Distance", "mm", {"min 1", "beyond: as the ends"}, false};
  both.describe(text);
  EXPECT_EQ(text.labels.size(), 2u);
  EXPECT_EQ(text.subtitle, "by the limits of each group");
  const FaceScales one(scale, {.tolerance = Tolerance(-1, 1)});
  EXPECT_FALSE(one.by_group());
  EXPECT_EQ(one(0, 3), scale(3));
}

// What fails by the limits of its group is seen in views: of a cube whose distance is x, all but its middle.
TEST(Views, ShowWhatFailsByTheLimitsOfItsGroup) {
  const CubeScene scene;
  const TemporaryFolder folder;
  const std::vector<FaceNames> names{
      {.kind = "group", .names = {"all"}, .of_face = std::vector<std::uint32_t>(12, 0)}};
  const auto warm_and_green = [&](const Tolerance& limits) {
    const std::vector<GroupTolerance> table{{"all", limits}};
    write_views_png(folder / "views.png", scene.surface, scene.map, scene.vertices, nullptr,
                    {.table = table, .names = names});
    const Pixels pixels = read_png(folder / "views.png");
    const ViewLayout layout = layout_views(bounds(scene.surface.mesh()), UpAxis::y);
    const Projection& front = layout.views[0].projection;
    std::array<int, 2> counts{};
    for (double x = -0.95; x < 1; x += 0.1) {
      const Vec3 at = front(Vec3{x, 0.5, 1});
      const Rgb c = pixels.at(std::size_t(layout.views[0].x + at[0]), std::size_t(layout.views[0].y + at[1]));
      ++counts[c.g >= c.r && c.g >= c.b ? 1 : 0];
    }
    return counts;
  };
  EXPECT_EQ(warm_and_green({-2, 2})[0], 0);
  const auto [out, within] = warm_and_green({-0.1, 0.1});
  EXPECT_GT(out, 15);
  EXPECT_GT(within, 0);
}

// So do the picture of the atlas, and its texture in a model.
TEST(FaceScales, AreThoseOfTheAtlasAndOfModels) {
  const CubeScene scene;
  const TemporaryFolder folder;
  std::vector<std::uint32_t> halves(12, 0);
  std::fill(halves.begin() + 6, halves.end(), kNone);
  const std::vector<FaceNames> names{{.kind = "group", .names = {"some"}, .of_face = halves}};
  const std::vector<GroupTolerance> table{{"some", Tolerance(-0.1, 0.1)}};
  const auto has = [&](const PictureOptions& options, Rgb color) {
    write_distance_png(folder / "atlas.png", scene.surface, scene.map, options);
    return std::ranges::count(read_png(folder / "atlas.png").colors, color) > 100;
  };
  EXPECT_TRUE(has({.table = table, .names = names}, kUnjudged));
  EXPECT_TRUE(has({.table = table, .names = names}, kAbove[2]));
  EXPECT_FALSE(has({}, kUnjudged));
  const auto texture = [&](const PictureOptions& options) {
    write_glb(folder / "model.glb", scene.surface, scene.map, scene.vertices, options);
    std::ifstream file(folder / "model.glb", std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    const std::size_t begin = bytes.find("\x89PNG");
    std::ofstream(folder / "texture.png", std::ios::binary) << bytes.substr(begin);
    return read_png(folder / "texture.png").colors;
  };
  EXPECT_GT(std::ranges::count(texture({.table = table, .names = names}), kUnjudged), 100);
  EXPECT_EQ(std::ranges::count(texture({}), kUnjudged), 0);
}

TEST(Views, StateTheVerdictInItsColour) {
  const CubeScene scene;
  const TemporaryFolder folder;
  const auto has = [&](std::optional<Verdict> verdict, Rgb color) {
    write_views_png(folder / "views.png", scene.surface, scene.map, scene.vertices, nullptr,
                    {.verdict = verdict});
    return std::ranges::count(read_png(folder / "views.png").colors, color) > 1000;
  };
  EXPECT_TRUE(has(Verdict::fail, {163, 19, 14}));
  EXPECT_TRUE(has(Verdict::pass, {0, 97, 61}));
  EXPECT_TRUE(has(Verdict::not_decided, {122, 75, 0}));
  for (const Rgb color : {Rgb{163, 19, 14}, Rgb{0, 97, 61}}) EXPECT_FALSE(has(std::nullopt, color));
}

TEST(Views, AreDrawnOfAnyMesh) {
  const TemporaryFolder folder;
  std::mt19937 random(5);
  const Mesh far = moved(cube(1e-3), {1e12, 0, 0});
  for (const Mesh& mesh : {single_triangle(), square(1, 0), needles(1e-9), degenerate_soup(60, 4),
                           moved(cube(1e25), {1e30, 0, 0}), band(20, true)}) {
    const Surface surface(mesh, {.resolution = 128});
    const Field field = [&](const Vec3& p) { return p[1] > 0 ? std::nan("") : p[0]; };
    const DistanceMap map = map_of(surface, field);
    write_views_png(folder / "views.png", surface, map, at_vertices(mesh, field), &far, {.units = "mm"});
    EXPECT_GT(read_png(folder / "views.png").width, 1000u);
  }
  const Surface surface(cube(), {.resolution = 64});
  EXPECT_THROW(write_views_png(folder / "no.png", surface, {}, {}), Error);
  EXPECT_FALSE(std::filesystem::exists(folder / "no.png"));
}

TEST(Views, DoNotDependOnTheNumberOfThreads) {
  const CubeScene scene;
  const TemporaryFolder folder;
  write_views_png(folder / "many.png", scene.surface, scene.map, scene.vertices, nullptr);
  const ThreadLimit limit(1);
  write_views_png(folder / "one.png", scene.surface, scene.map, scene.vertices, nullptr);
  EXPECT_EQ(read_png(folder / "many.png").colors, read_png(folder / "one.png").colors);
}

}  // namespace
}  // namespace sdm::test
