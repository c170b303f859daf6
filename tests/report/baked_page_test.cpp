// The page of `sdm bake`, and its models in three.js.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sdm/bake.h>
#include <sdm/bake_files.h>
#include <sdm/error.h>

#include <cmath>
#include <cstdint>
#include <fstream>
#include <numbers>

#include "report/page_browser.h"
#include "report/page_fixture.h"
#include "support/error_of.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

/// A ball with bumps, whose colours change smoothly.
Mesh bumpy_ball(int levels) {
  Mesh ball = sphere(levels);
  for (Vec3& p : ball.positions) p = (1 + 0.03 * std::sin(9 * p[0]) * std::sin(8 * p[1] + 1)) * p;
  return ball;
}

void write_colored_ply(const std::string& file, const Mesh& mesh) {
  std::ofstream out(file);
  out << "ply\nformat ascii 1.0\nelement vertex " << mesh.positions.size()
      << "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
         "property uchar blue\nelement face "
      << mesh.triangles.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
  const auto level = [](double x) { return std::lround(127.5 + 90 * std::sin(2 * x)); };
  for (const Vec3& p : mesh.positions)
    out << fmt::format("{:.7} {:.7} {:.7} {} {} {}\n", p[0], p[1], p[2], level(p[0]), level(p[1] + 1),
                       level(p[2] + 2));
  for (const Triangle& t : mesh.triangles) out << fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
}

struct BakedPage : ::testing::Test {
  TemporaryFolder folder;
  std::string high = folder / "high.ply", low = write_obj(folder / "low.obj", sphere(2)),
              out = folder / "out";

  void run(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"bake", high, low, "-o", out, "--resolution", "256"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_sdm(arguments);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
  }
  [[nodiscard]] std::string page() const { return out + "/report.html"; }
  [[nodiscard]] std::string report() const { return out + "/report.json"; }
};

TEST_F(BakedPage, ComparesBothMeshes) {
  write_colored_ply(high, bumpy_ball(5));
  const std::string channels = has_tangents() ? "base_color,normal" : "base_color";
  run({"--channels", channels, "--match", "ray", "--units", "mm", "--gutter", "4"});
  EXPECT_TRUE(passes("slides", page()));
  EXPECT_TRUE(passes("compares", page()));
  EXPECT_TRUE(
      passes("statesFacts", page(), {report(), "with its colours and normals at the corners of triangles."}));
  EXPECT_TRUE(looks("looks", page()));
  EXPECT_TRUE(looks("touches", page()));
}

// Without a normal map, the coarse mesh has its own shape.
TEST_F(BakedPage, ShowsCoarserCopiesAndSamples) {
  write_colored_ply(high, bumpy_ball(7));  // 327,680 triangles
  run({"--samples", "4"});
  EXPECT_TRUE(passes("statesFacts", page(), {report(), "is drawn by a coarser copy, "}));
  EXPECT_TRUE(passes("slides", page(), {"differs"}));
}

// Of few triangles with a texture, the page has colours between their corners.
TEST_F(BakedPage, DividesTrianglesWithATexture) {
  high = folder / "high.obj";
  low = write_obj(folder / "flat.obj", square(2, 0));
  std::ofstream(folder / "high.mtl") << "newmtl picture\nmap_Kd picture.png\n";
  Image image{.width = 64, .height = 64, .components = 3, .bits = 8, .bytes = {}};
  const auto wave = [](int at) { return static_cast<int>(128 + 100 * std::sin(at * std::numbers::pi / 32)); };
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      for (const int value : {wave(x), wave(y), wave(x + y)})
        image.bytes.push_back(static_cast<std::uint8_t>(value));
  const std::vector<char> png = encode_png(image);
  std::ofstream(folder / "picture.png", std::ios::binary)
      .write(png.data(), static_cast<std::streamsize>(png.size()));
  std::ofstream(high)
      << "mtllib high.mtl\nusemtl picture\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\n"
         "vt 1 1\nvt 0 1\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n";
  run({"--up", "z"});
  EXPECT_TRUE(passes("statesFacts", page(), {report(), "with each of its triangles divided into 1024"}));
  EXPECT_TRUE(passes("slides", page()));
}

// Roughness and metal, of a texture on one mesh and at the corners of the other.
TEST_F(BakedPage, ShowsRoughnessAndMetal) {
  const Mesh ball = sphere(5);
  high = folder / "high.obj";
  std::ofstream(folder / "high.mtl") << "newmtl metal\nKd 0.8 0.6 0.3\nPm 1\nPr 0.15\n"
                                        "newmtl rough\nKd 0.8 0.6 0.3\nPm 0\nPr 1\n";
  std::ofstream out_of_high(high);
  out_of_high << "mtllib high.mtl\n";
  for (const Vec3& p : ball.positions) out_of_high << fmt::format("v {} {} {}\n", p[0], p[1], p[2]);
  for (const bool metal : {true, false}) {  // on either side of the middle of the picture
    out_of_high << (metal ? "usemtl metal\n" : "usemtl rough\n");
    for (const Triangle& t : ball.triangles)
      if ((ball.positions[t[0]][0] > ball.positions[t[0]][2]) == metal)
        out_of_high << fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  }
  out_of_high.close();
  low = write_obj(folder / "low.obj", sphere(4));
  run();
  EXPECT_TRUE(passes("shines", page()));
}

// The normals of the detailed mesh are what three.js decodes from the model, drawn into floats.
TEST_F(BakedPage, NormalMapsAreThoseOfThreeJs) {
  if (!has_tangents()) GTEST_SKIP() << "without MikkTSpace";
  const Mesh detailed = bumpy_ball(5);
  const Surface surface(sphere(3), {.resolution = 256});
  const Sites sites(detailed);
  const TexelMatches matches = match_texels(surface, sites, {.method = MatchMethod::ray});
  const MeshAttribute normals = smooth_normals(surface.mesh(), kDrawnCrease);
  const MeshAttribute frames = tangents(surface, normals);
  const std::vector<float> wanted = matched_normals(surface, sites, matches, smooth_normals(detailed));
  std::vector<float> baked = tangent_space_normals(surface, normals, frames, wanted);
  fill_texels(surface, 3, baked);
  const std::vector<char> png = encode_png(normal_map_image(surface, baked), false);
  const std::string model = folder / "model.glb", floats = folder / "normals.bin";
  write_baked_glb(model, surface, {}, {.normals = &normals, .normal_map = png, .tangents = &frames});
  std::ofstream(floats, std::ios::binary)
      .write(reinterpret_cast<const char*>(wanted.data()),
             static_cast<std::streamsize>(wanted.size() * sizeof(float)));
  EXPECT_TRUE(passes("decodes", model, {floats, "0.7", folder / "decoded.html"}));
}

TEST_F(BakedPage, RefusesWhatDoesNotFit) {
  const Mesh ball = sphere(1);
  const MeshAttribute other = smooth_normals(sphere(2));
  EXPECT_EQ(error_of([&] {
              (void)DetailedView({ball, {}, &other}, ball);
            }),
            "the normals of the detailed mesh do not fit it");
}

}  // namespace
}  // namespace sdm::test
