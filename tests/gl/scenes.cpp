#include "gl/scenes.h"

#include <algorithm>
#include <random>

#include "support/meshes.h"
#include "support/points.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using Maker = std::function<Mesh()>;

Maker file(const char* name, const char* steps = "fit") {
  return [=] { return load(name, steps); };
}
Maker box(double half_side, const char* steps = "") {
  return [=] { return placed(cube(half_side), steps); };
}
Maker ball(int levels, const char* steps = "") {
  return [=] { return placed(sphere(levels), steps); };
}

// Triangles with an angle of almost 180°, and a small box, because a mesh must have some area.
Mesh caps() {
  Mesh mesh = placed(cube(0.01), "translate:-1:0:0");
  double y = 0;
  for (const double height : {1e-3, 1e-5, 1e-7, 1e-9, 1e-12, 0.0}) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {{0, y, 0}, {1, y, 0}, {0.4, y + height, 0}});
    mesh.triangles.push_back({first, first + 1, first + 2});
    y += 0.2;
  }
  return mesh;
}

// Pages on one spine.
Mesh book() {
  std::mt19937 random(6);
  Mesh mesh{.positions = {{0, 0, -0.5}, {0, 0, 0.5}}, .triangles = {}, .corner_uvs = {}};
  for (std::uint32_t i = 2; i < 40; ++i) {
    mesh.positions.push_back(random_point({{-1, -1, -1}, {1, 1, 1}}, random));
    mesh.triangles.push_back({0, 1, i});
  }
  return mesh;
}

// A triangle with a tip so sharp that it moves far if its walls move outwards slightly.
Mesh sharp_tip(double width) {
  return {.positions = {{0.2, 0, 0}, {-1, width / 2, 0}, {-1, -width / 2, 0}},
          .triangles = {{0, 1, 2}},
          .corner_uvs = {}};
}

// A square above it, with a row of its 32² texels on the tip's axis.
Mesh over_the_tip() {
  const double y = 0.5 / 32;
  Mesh mesh{.positions = {{-0.5, -0.5 - y, 0.05},
                          {0.5, -0.5 - y, 0.05},
                          {0.5, 0.5 - y, 0.05},
                          {-0.5, 0.5 - y, 0.05}},
            .triangles = {{0, 1, 2}, {0, 2, 3}},
            .corner_uvs = {}};
  for (const Triangle& t : mesh.triangles) {
    auto& corners = mesh.corner_uvs.emplace_back();
    for (int k = 0; k < 3; ++k)
      corners[k] = {mesh.positions[t[k]][0] + 0.5, mesh.positions[t[k]][1] + 0.5 + y};
  }
  return mesh;
}

Maker triangles_at_random(std::size_t count) {
  return [=] {
    std::mt19937 random(5);
    return soup(count, random);
  };
}

// Details of 1e-3 at 1e5.
#define SDM_FAR_AWAY "scale:0.001,translate:100000:-100000:100000"

const std::vector<Scene> kScenes{
    // Closed: side by side, penetrating, and far apart.
    {"Apart", file("bunny.obj"), file("armadillo.off", "fit,translate:0.8:0:0")},
    {"Penetrating", file("head.off"), file("armadillo.off"), {.resolution = 256}, true},
    {"LargeMap", file("head.off"), file("elephant.off"), {.resolution = 1024}, true},
    {"SmallMap", ball(1), file("blobby.off"), {.resolution = 16}},
    {"TenSizesApart", file("elephant.off"), file("head.off", "fit,translate:10:3:-2"), {.resolution = 128}},
    {"ThousandSizesApart",
     file("head.off"),
     file("elephant.off", "fit,translate:1000:0:0"),
     {.resolution = 128}},
    // Open, of many components, non-manifold, degenerate.
    {"Holes", file("lion-head.off", "fit,translate:0.3:0.2:0.1"), file("elephant-with-holes.off")},
    {"Parts", file("bear_bis.off"), file("blobby_3cc.off")},
    {"WithDefects", file("head.off"), [] { return with_defects(load("blobby.off", "fit")); }},
    {"OnMeshWithDefects",
     [] { return with_defects(load("blobby.off", "fit")); },
     file("head.off"),
     {.resolution = 512}},
    {"ZeroAreaFaces", file("triceratops.off"), file("degtri_sliding.off", "fit,translate:0.4:0:0")},
    {"Polygons", file("dino.off"), file("boeing.off")},
    {"Soup", ball(2), triangles_at_random(400)},
    {"OnSoup",
     triangles_at_random(300),
     ball(3, "scale:0.4,translate:0.5:0.5:0.5"),
     {.resolution = 256},
     true},
    {"Book", ball(2), [] { return book(); }},
    // Few faces, and large ones.
    {"FigureInBox", file("lion-head.off"), box(0.55)},
    {"BoxAroundFigure", box(0.55), file("lion-head.off")},
    {"OneTriangle", ball(2), single_triangle},
    {"OnOneTriangle", single_triangle, ball(3, "scale:0.4"), {.resolution = 128}, true},
    // Ties and contact.
    {"Identical", file("elephant.off"), file("elephant.off")},
    {"CoplanarContact", box(1), box(1, "translate:2:0.5:0.25"), {.resolution = 128}},
    {"BoxesCrossing", box(1), box(1, "translate:0.5:0.5:0.5"), {.resolution = 128}, true},
    {"ConcentricSpheres", ball(3), ball(4, "scale:2"), {.resolution = 128}},
    {"SmallConcentricSphere", ball(2, "scale:0.001"), ball(3), {.resolution = 128}},
    // Slivers.
    {"Needles", ball(2, "translate:0.5:0:0"), [] { return needles(1e-3); }, {.resolution = 128}},
    {"ThinNeedles",
     ball(2, "scale:0.1,translate:0.5:0:0.02"),
     [] { return needles(1e-9); },
     {.resolution = 128}},
    {"OnNeedles",
     [] { return needles(1e-3); },
     ball(2, "scale:0.1,translate:0.5:0:0.02"),
     {.kind = AtlasKind::triangles, .resolution = 512}},
    {"Caps", ball(2, "scale:0.7,translate:0.5:0.5:0"), [] { return caps(); }, {.resolution = 128}},
    {"SharpTip", over_the_tip, [] { return sharp_tip(1e-3); }, {.kind = AtlasKind::uv, .resolution = 32}},
    {"SharperTip", over_the_tip, [] { return sharp_tip(1e-5); }, {.kind = AtlasKind::uv, .resolution = 32}},
    // Units.
    {"SmallDetailFarAway",
     box(1, SDM_FAR_AWAY),
     ball(2, "translate:0.5:0.7:0.9," SDM_FAR_AWAY),
     {.resolution = 128},
     true},
    {"Tiny",
     file("head.off", "fit,scale:1e-6"),
     file("elephant.off", "fit,scale:1e-6"),
     {.resolution = 128},
     true},
    {"Huge",
     file("head.off", "fit,scale:1e6"),
     file("elephant.off", "fit,scale:1e6"),
     {.resolution = 128},
     true},
    {"TinyBesideLarge", box(1), ball(1, "scale:1e-6,translate:1:1:1"), {.resolution = 64}},
    // The other atlases.
    {"AtlasOfTriangles",
     file("head.off"),
     file("elephant.off"),
     {.kind = AtlasKind::triangles, .resolution = 512},
     true},
    {"OwnCoordinates",
     [] { return with_own_uvs(load("head.off", "fit"), 256); },
     file("elephant.off"),
     {.kind = AtlasKind::uv, .resolution = 512},
     true},
    {"WideTexture",
     [] { return with_own_uvs(load("head.off", "fit"), 256); },
     file("elephant.off"),
     {.kind = AtlasKind::uv, .resolution = 700, .rows = 150},
     true},
    {"HighTexture",
     [] { return with_own_uvs(load("head.off", "fit"), 256); },
     file("elephant.off"),
     {.kind = AtlasKind::uv, .resolution = 90, .rows = 800},
     true},
};

}  // namespace

const std::vector<Scene>& scenes() {
  return kScenes;
}

const Scene& scene(std::string_view name) {
  return *std::ranges::find(kScenes, name, &Scene::name);
}

std::string scene_name(const testing::TestParamInfo<Scene>& info) {
  return info.param.name;
}

void PrintTo(const Scene& scene, std::ostream* out) {
  *out << scene.name;
}

}  // namespace sdm::test
