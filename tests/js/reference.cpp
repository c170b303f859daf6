// Writes pairs of meshes and what the library computes of them, for comparison with its WebAssembly modules
// and with builds for other systems: js_reference FOLDER [GIVEN]. Arrays are files of plain numbers, and
// pairs.json names them. Positions and texture coordinates, which depend on the sines and roundings of a
// system, are those in the folder GIVEN.
#include <sdm/closest_points.h>
#include <sdm/hausdorff.h>
#include <sdm/measure.h>
#include <sdm/mesh_edit.h>
#include <sdm/proximity_query.h>
#include <sdm/sites.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <random>
#include <span>
#include <string>

#include "support/shapes.h"

namespace {

using namespace sdm;
using namespace sdm::test;

constexpr Vec3 kUpwards{0.25, -0.5, 1};

struct Pair {
  std::string name;
  Mesh o1, o2;
};

Mesh turned(Mesh mesh, const Vec3& degrees, const Vec3& offset, double scale = 1) {
  transform(mesh, Transform::translation(offset) * Transform::rotation(degrees) * Transform::scaling(scale));
  return mesh;
}

std::vector<Pair> pairs() {
  std::mt19937 random(7);
  const std::vector<std::pair<std::string, Mesh>> shapes{{"tetrahedron", tetrahedron()},
                                                         {"cube", cube()},
                                                         {"sphere", sphere(4)},
                                                         {"torus", torus(40, 20)},
                                                         {"wedge", wedge(0.1)},
                                                         {"spiral", spiral_ramp(3, 30)},
                                                         {"fan", fan(50)},
                                                         {"needles", needles(1e-3)},
                                                         {"field", height_field(24)},
                                                         {"soup", soup(300, random)}};
  std::vector<Pair> result;
  for (std::size_t i = 0; i < 2 * shapes.size(); ++i) {
    const auto& [name1, o1] = shapes[i % shapes.size()];
    const auto& [name2, o2] = shapes[(3 * i + 2) % shapes.size()];
    std::uniform_real_distribution<double> any(-1, 1);
    const Vec3 angles{180 * any(random), 180 * any(random), 180 * any(random)};
    const Vec3 offset{any(random), any(random), any(random)};
    result.push_back({name1 + "-" + name2, o1, turned(o2, angles, offset, i < shapes.size() ? 1 : 0.6)});
  }
  return result;
}

class Files {
 public:
  Files(std::filesystem::path folder, std::filesystem::path given)
      : folder_(std::move(folder)), given_(std::move(given)) {}
  /// Replaces the values by those of the file in the other folder, if there is one.
  template <class Value>
  void take_given(const std::string& name, std::vector<Value>& values) const {
    if (given_.empty()) return;
    const auto bytes = std::as_writable_bytes(std::span(values));
    if (std::filesystem::file_size(given_ / name) != bytes.size())
      throw std::runtime_error(name + " has another size than expected");
    std::ifstream in(given_ / name, std::ios::binary);
    in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (!in) throw std::runtime_error(name + " was not read");
  }
  template <class Range>
  void write(const std::string& name, const Range& values) const {
    std::ofstream out(folder_ / name, std::ios::binary);
    const auto bytes = std::as_bytes(std::span(values));
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (!out.flush()) throw std::runtime_error(name + " was not written");
  }

 private:
  std::filesystem::path folder_, given_;
};

std::vector<Vec3> random_points(const Mesh& around, std::size_t count, unsigned seed) {
  const Box box = bounds(around);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(-0.5, 1.5);
  std::vector<Vec3> points(count);
  for (Vec3& point : points)
    for (std::size_t k = 0; k < 3; ++k) point[k] = box.lower[k] + any(random) * (box.upper[k] - box.lower[k]);
  return points;
}

void write_mesh(const Files& files, const std::string& name, const Mesh& mesh) {
  files.write(name + ".positions", mesh.positions);
  files.write(name + ".indices", mesh.triangles);
}

/// The faces that have an area, with corners of their own, and an atlas that does not depend on the
/// platform's rounding: texture coordinates, two for each vertex.
Mesh with_fixed_atlas(const Mesh& mesh, const Files& files, const std::string& name) {
  const Mesh laid_out = with_own_uvs({mesh.positions, mesh.triangles, {}}, 128);
  Mesh result;
  std::vector<Vec2> uvs;
  for (std::size_t face = 0; face < mesh.triangles.size(); ++face) {
    if (std::isnan(laid_out.corner_uvs[face][0][0])) continue;  // no area
    const auto first = static_cast<std::uint32_t>(uvs.size());
    result.corner_uvs.push_back(laid_out.corner_uvs[face]);
    result.triangles.push_back({first, first + 1, first + 2});
    for (std::size_t k = 0; k < 3; ++k) {
      result.positions.push_back(mesh.positions[mesh.triangles[face][k]]);
      uvs.push_back(laid_out.corner_uvs[face][k]);
    }
  }
  files.take_given(name + ".uvs", uvs);
  for (std::size_t face = 0; face < result.triangles.size(); ++face)
    for (std::size_t k = 0; k < 3; ++k) result.corner_uvs[face][k] = uvs[3 * face + k];
  files.write(name + ".uvs", uvs);
  return result;
}

void write_values(const Files& files, const std::string& name, const DistanceMap& map) {
  files.write(name + ".distances", std::span(map.distance).first(map.texels()));
}

/// The maps of a mesh by itself, of an atlas that is stored. Returns the names of the maps, as JSON.
std::string write_measures_of_itself(const Files& files, const std::string& name, const Mesh& mesh) {
  const Surface surface({mesh.positions, mesh.triangles, {}}, {.resolution = 64});
  const Sites sites(surface.mesh());
  files.write(name + ".atlas", surface.stored_atlas());
  const Exclusion exclusion(mesh, {.rule = {.rings = 2}}), near(mesh, {.rule = {.geodesic = 0.3}});
  write_values(files, name + ".rings", compute_map(surface, sites, SelfOptions{exclusion, 1.5}));
  write_values(files, name + ".geodesic", compute_map(surface, sites, SelfOptions{near}));
  if (!sites.closed() || !sites.orientable()) return R"(["rings", "geodesic"])";
  write_values(files, name + ".ball", compute_map(surface, sites, ThicknessOptions{.angle = 60}));
  write_values(files, name + ".ray",
               compute_map(surface, sites, ThicknessOptions{.method = ThicknessMethod::ray}));
  return R"(["rings", "geodesic", "ball", "ray"])";
}

/// Returns the numbers of the pair, as JSON.
std::string write_pair(const Files& files, Pair pair, unsigned number) {
  const std::string name = std::to_string(number);
  files.take_given(name + ".o1.positions", pair.o1.positions);
  files.take_given(name + ".o2.positions", pair.o2.positions);
  write_mesh(files, name + ".o1", pair.o1);
  write_mesh(files, name + ".o2", pair.o2);
  const Mesh apart = with_fixed_atlas(pair.o1, files, name + ".apart");
  write_mesh(files, name + ".apart", apart);
  const Surface surface(apart, {.kind = AtlasKind::uv, .resolution = 128});
  const Sites sites(pair.o2);
  const DistanceMap map = compute_map(surface, sites);
  files.write(name + ".texel_faces", surface.texel_faces());
  files.write(name + ".distances", std::span(map.distance).first(map.texels()));
  files.write(name + ".vectors", map.vector);

  write_values(files, name + ".reference", compute_map(surface, sites, {.engine = make_engine("reference")}));
  write_values(files, name + ".along", compute_map(surface, sites, AlongOptions{}));
  write_values(files, name + ".upwards", compute_map(surface, sites, AlongOptions{.direction = kUpwards}));
  const std::string of_itself = write_measures_of_itself(files, name, pair.o1);

  const std::vector<Vec3> points = random_points(pair.o2, 500, number);
  const std::vector<ClosestPoint> closest = closest_points(sites, points);
  const auto inside = inside_flags(sites, points, closest, choose_sign(sites, SignMethod::automatic).method);
  std::vector<double> signed_distances;
  std::vector<Vec3> feet;
  for (std::size_t i = 0; i < points.size(); ++i) {
    signed_distances.push_back(inside[i] ? -closest[i].distance : closest[i].distance);
    feet.push_back(closest[i].point);
  }
  files.write(name + ".points", points);
  files.write(name + ".closest", feet);
  files.write(name + ".signed", signed_distances);

  const BoundedLength hausdorff = symmetric_hausdorff(Sites(pair.o1), sites).larger.distance;
  ProximityQuery query(pair.o1, pair.o2);
  std::array<char, 400> text{};
  std::snprintf(
      text.data(), text.size(),
      R"({"name": "%s", "hausdorff": [%.17g, %.17g], "separation": %.17g, "colliding": %s, "contacts": %zu, "of_itself": %s})",
      pair.name.c_str(), hausdorff.lower, hausdorff.upper, query.separation().value,
      query.colliding() ? "true" : "false", query.contacts().size(), of_itself.c_str());
  return text.data();
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2 && count != 3) return std::cerr << "usage: js_reference FOLDER [GIVEN]\n", 2;
  std::filesystem::create_directories(arguments[1]);
  const Files files(arguments[1], count == 3 ? arguments[2] : "");
  std::string json;
  unsigned number = 0;
  for (Pair& pair : pairs())
    json += (json.empty() ? "[\n" : ",\n") + write_pair(files, std::move(pair), number++);
  files.write("pairs.json", json + "\n]\n");
}
