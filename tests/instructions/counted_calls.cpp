// Calls of the library on fixed inputs, whose instructions check.py counts with Callgrind.
//
//   counted_calls --list | NAME
//
// Counting starts where a call starts and stops where it returns, so that making inputs and verifying results
// neither counts nor takes the time of instrumented code. A process makes one call: what an earlier one left
// in caches and in the memory of the process would change its count.
#include <sdm/align.h>
#include <sdm/closest_points.h>
#include <sdm/engine.h>
#include <sdm/execution.h>
#include <sdm/map.h>
#include <sdm/measure.h>
#include <sdm/mesh_files.h>
#include <sdm/proximity_query.h>
#include <sdm/sites.h>
#include <sdm/surface.h>
#include <sdm/types.h>
#include <valgrind/callgrind.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <memory>
#include <new>
#include <numbers>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sdm::test {
namespace {

/// work(), counted.
void count(const auto& work) {
  CALLGRIND_START_INSTRUMENTATION;
  work();
  CALLGRIND_STOP_INSTRUMENTATION;
}

/// An installed mesh whose longest side is 1, with its centre at the origin.
Mesh load(const std::string& name) {
  Mesh mesh = read_mesh(SDM_TEST_MESHES "/" + name);
  transform(mesh, fit_to_unit(mesh));
  return mesh;
}

Mesh moved(Mesh mesh, const Transform& motion) {
  transform(mesh, motion);
  return mesh;
}

Mesh beside(const Mesh& mesh) {
  return moved(mesh, Transform::translation({0.8, 0, 0}));
}

double diagonal_of(const Mesh& mesh) {
  const Box box = bounds(mesh);
  return norm(box.upper - box.lower);
}

/// Whether some of the distances are those of the reference engine, which shares no search with the cpu
/// engine.
bool agree(const Sites& sites, std::span<const Vec3> points, std::span<const double> distances) {
  constexpr std::size_t kStep = 101;
  std::vector<Vec3> some;
  for (std::size_t i = 0; i < points.size(); i += kStep) some.push_back(points[i]);
  const auto expected = closest_points(sites, some, {.engine = make_engine("reference")});
  const double tolerance = 1e-5 * diagonal_of(sites.mesh());
  bool same = !some.empty() && points.size() == distances.size();
  for (std::size_t i = 0; same && i < some.size(); ++i)
    same = std::abs(distances[i * kStep] - expected[i].distance) <= tolerance;
  return same;
}

bool build_sites() {
  const Mesh mesh = load("armadillo.off");
  std::optional<Sites> sites;
  count([&] { sites.emplace(mesh); });
  return sites->closed() && 2 * sites->edges().size() == 3 * mesh.triangles.size();
}

bool build_shape() {
  const Mesh mesh = load("armadillo.off");
  std::optional<Shape> shape;
  count([&] { shape.emplace(mesh); });
  return !shape->convex();
}

/// With all checks.
bool read_stored_shape() {
  const Shape built(load("armadillo.off"));
  std::vector<std::byte> bytes;
  built.store([&](std::span<const std::byte> part) { bytes.insert(bytes.end(), part.begin(), part.end()); });
  constexpr std::align_val_t kAlignment{64};
  auto* const data = static_cast<std::byte*>(::operator new(bytes.size(), kAlignment));
  const std::shared_ptr<void> owner(data, [](void* memory) { ::operator delete(memory, kAlignment); });
  std::ranges::copy(bytes, data);
  std::optional<Shape> shape;
  count([&] { shape.emplace(StoredShape{.bytes = {data, bytes.size()}, .owner = owner}); });
  const Shape other(load("cow.off"));
  const auto separation = [&](const Shape& of) {
    ProximityQuery query(of, other);
    query.set_pose(1, Transform::translation({2, 0, 0}));
    return query.separation().value;
  };
  return separation(*shape) == separation(built);
}

bool build_surface() {
  const Mesh mesh = load("camel.off");
  std::optional<Surface> surface;
  count([&] { surface.emplace(mesh, AtlasOptions{.resolution = 512}); });
  return surface->utilisation() > 0.5 && surface->max_stretch() <= 1.3 &&
         std::ranges::count(surface->face_charts(), kNone) == 0;
}

/// Both objects of a map, as in each frame of a simulation.
bool refit() {
  const Mesh mesh = load("armadillo.off");
  Surface surface(mesh, {.resolution = 256});
  Sites sites(mesh);
  std::vector<Vec3> positions = mesh.positions;
  for (Vec3& p : positions) p[0] += 0.05 * std::sin(2 * std::numbers::pi * p[1]);
  count([&] {
    surface.refit(positions);
    sites.refit(positions);
  });
  // Samples lie on the surface, and both have moved.
  const std::vector<Vec3> points = surface.sample_points();
  const std::vector<ClosestPoint> closest = closest_points(sites, points);
  const bool same = std::ranges::all_of(closest, [](const ClosestPoint& c) { return c.distance < 1e-5; });
  return same && sites.mesh().positions == positions;
}

bool map(const std::string& o1, std::uint32_t resolution, const std::string& o2) {
  const Surface surface(load(o1), {.resolution = resolution});
  const Sites sites(beside(load(o2)));
  DistanceMap map;
  count([&] { map = compute_map(surface, sites); });
  std::vector<double> distances;
  for (const std::uint32_t texel : surface.sample_texels())
    distances.push_back(std::abs(map.distance[texel]));
  return map.sign.method == SignMethod::exact && agree(sites, surface.sample_points(), distances);
}

bool dense_map() {
  return map("cow.off", 768, "elephant.off");
}

bool sparse_map() {
  return map("cow.off", 192, "armadillo.off");
}

/// A map of a part to what belongs to it: vectors end on the surface, and none is longer than its distance.
bool map_of_part(const Surface& surface, const Sites& sites, const Measure& measure, bool reaches) {
  DistanceMap map;
  count([&] { map = compute_map(surface, sites, measure); });
  std::vector<Vec3> ends;
  bool good = map.beyond_max_distance == 0;
  for (const std::uint32_t texel : surface.sample_texels()) {
    const Vec3f& v = map.vector[texel];
    const Vec3 vector{v[0], v[1], v[2]};
    ends.push_back(surface.texel_point(texel) + vector);
    const double shorter = map.distance[texel] - norm(vector);
    good = good && shorter > -1e-5 && (!reaches || shorter < 1e-5) && map.distance[texel] > 0;
  }
  const std::vector<ClosestPoint> closest = closest_points(sites, ends);
  return good && std::ranges::all_of(closest, [](const ClosestPoint& c) { return c.distance < 1e-5; });
}

bool self_map() {
  const Mesh mesh = load("armadillo.off");
  const Exclusion exclusion(mesh);
  return map_of_part(Surface(mesh, {.resolution = 192}), Sites(mesh), SelfOptions{.exclusion = exclusion},
                     true);
}

bool thickness_map() {
  const Mesh mesh = load("armadillo.off");
  return map_of_part(Surface(mesh, {.resolution = 192}), Sites(mesh), ThicknessOptions{}, false);
}

bool scattered_points(const Sites& sites, const std::vector<Vec3>& points) {
  std::vector<ClosestPoint> closest;
  count([&] { closest = closest_points(sites, points); });
  std::vector<double> distances;
  for (const ClosestPoint& c : closest) distances.push_back(c.distance);
  return agree(sites, points, distances);
}

/// Off the vertices, by about as much as faces are long.
bool near_points() {
  const Sites sites(load("armadillo.off"));
  std::mt19937 random(1);
  std::normal_distribution<double> offset(0, 0.01);
  std::vector<Vec3> points = sites.mesh().positions;
  std::ranges::shuffle(points, random);
  for (Vec3& p : points)
    for (double& x : p) x += offset(random);
  return scattered_points(sites, points);
}

bool far_points() {
  const Sites sites(load("armadillo.off"));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> coordinate(-5, 5);
  std::vector<Vec3> points(50'000);
  for (Vec3& p : points)
    for (double& x : p) x = coordinate(random);
  return scattered_points(sites, points);
}

/// 30 diagonals from the centre of the box.
bool remote_points() {
  const Sites sites(load("armadillo.off"));
  const double away = 30 * diagonal_of(sites.mesh());
  std::mt19937 random(1);
  std::normal_distribution<double> coordinate;
  std::vector<Vec3> points(10'000);
  for (Vec3& p : points) {
    for (double& x : p) x = coordinate(random);
    p = away / norm(p) * p;
  }
  return scattered_points(sites, points);
}

/// Without its lowest tenth.
Mesh opened(Mesh mesh) {
  const Box box = bounds(mesh);
  const double least = box.lower[2] + 0.1 * (box.upper[2] - box.lower[2]);
  std::erase_if(mesh.triangles, [&](const Triangle& t) { return mesh.positions[t[0]][2] < least; });
  return mesh;
}

/// The cost of a point does not depend on the number of faces.
bool single_signs(const Mesh& mesh, SignMethod method) {
  constexpr int kCount = 1000;
  const Sites sites(mesh);
  std::mt19937 random(1);
  std::normal_distribution<double> offset(0, 0.05);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i <= kCount; ++i) {
    Vec3 p = mesh.positions[mesh.triangles[37 * i][0]];
    for (double& x : p) x += offset(random);
    points.push_back(p);
  }
  const auto inside = [&](const Vec3& p) {
    const std::vector<ClosestPoint> closest = closest_points(sites, {&p, 1});
    return inside_flags(sites, {&p, 1}, closest, method)[0];
  };
  (void)inside(points.back());
  points.pop_back();
  std::vector<std::uint8_t> found;
  count([&] {
    for (const Vec3& p : points) found.push_back(inside(p));
  });
  const auto closest = closest_points(sites, points);
  return found == inside_flags(sites, points, closest, method) &&
         std::ranges::count(found, 1) > kCount / 10 && std::ranges::count(found, 0) > kCount / 10;
}

bool single_signs_of_solid() {
  return single_signs(load("armadillo.off"), SignMethod::exact);
}

bool single_signs_by_winding() {
  return single_signs(opened(load("armadillo.off")), SignMethod::winding);
}

/// The first signs of a solid, as near as `near points` are.
bool near_signs() {
  const Sites sites(load("armadillo.off"));
  std::mt19937 random(1);
  std::normal_distribution<double> offset(0, 0.01);
  std::vector<Vec3> points = sites.mesh().positions;
  std::ranges::shuffle(points, random);
  for (Vec3& p : points)
    for (double& x : p) x += offset(random);
  const auto closest = closest_points(sites, points);
  std::vector<std::uint8_t> first;
  count([&] { first = inside_flags(sites, points, closest, SignMethod::exact); });
  std::ranges::reverse(points);
  std::ranges::reverse(first);
  return first == inside_flags(sites, points, closest_points(sites, points), SignMethod::exact);
}

/// Rotations of O2, which then is `distance` from the origin, each time in another direction.
std::vector<Transform> poses(int count, double distance) {
  std::vector<Transform> result;
  for (int i = 0; i < count; ++i) {
    // Points of a spiral that cover the sphere evenly.
    const double z = 1 - (2 * i + 1.0) / count, angle = 2.4 * i, radius = std::sqrt(1 - z * z);
    const Vec3 direction{radius * std::cos(angle), radius * std::sin(angle), z};
    result.push_back(Transform::translation(distance * direction) *
                     Transform::rotation({37.0 * i, 59.0 * i, 83.0 * i}));
  }
  return result;
}

/// Whether the witness has a point of each body, the value apart. `pose`: of body 1.
bool on_both(ProximityQuery& query, const Transform& pose, const BoundedLength& length) {
  if (!length.witness) return false;
  const auto& [p, q] = *length.witness;
  const std::vector<Vec3> points{p, pose.inverse()(q)};
  const double off0 = closest_points(query.sites(0), {&points[0], 1})[0].distance;
  const double off1 = closest_points(query.sites(1), {&points[1], 1})[0].distance;
  return off0 < 1e-5 && off1 < 1e-5 && std::abs(norm(q - p) - length.value) < 1e-5;
}

bool separation() {
  ProximityQuery query(load("bunny.obj"), load("armadillo.off"));
  const std::vector<Transform> all = poses(200, 1.2);
  std::vector<BoundedLength> found;
  count([&] {
    for (const Transform& pose : all) {
      query.set_pose(1, pose);
      found.push_back(query.separation());
    }
  });
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::vector<Vec3> vertices = query.sites(1).mesh().positions;
    transform(vertices, all[i]);
    const auto closest = closest_points(query.sites(0), vertices, {.max_distance = 1.01 * found[i].value});
    const double least = std::ranges::min(closest, {}, &ClosestPoint::distance).distance;
    if (!(found[i].value > 0 && found[i].value <= least + 1e-5) || !on_both(query, all[i], found[i]))
      return false;
  }
  return true;
}

bool penetration_depth() {
  constexpr double kPrecision = 1e-3;
  ProximityQuery query(load("elephant.off"), load("dino.off"), {.depth_precision = kPrecision});
  const std::vector<Transform> all = poses(20, 0.2);
  std::vector<BoundedLength> found;
  count([&] {
    for (const Transform& pose : all) {
      query.set_pose(1, pose);
      found.push_back(query.penetration_depth().value());
    }
  });
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::vector<Vec3> vertices = query.sites(1).mesh().positions;
    transform(vertices, all[i]);
    const auto closest = closest_points(query.sites(0), vertices);
    const auto inside = inside_flags(query.sites(0), vertices, closest, SignMethod::exact);
    for (std::size_t v = 0; v < vertices.size(); ++v)
      if (inside[v] != 0 && closest[v].distance > found[i].upper + 1e-5) return false;
    if (!(found[i].lower > 0 && found[i].upper - found[i].lower < 1.1 * kPrecision) ||
        !on_both(query, all[i], found[i]))
      return false;
  }
  return true;
}

bool alignment() {
  const Mesh mesh = load("camel.off");
  const Sites sites(mesh);
  const Transform motion = Transform::translation({0.02, -0.01, 0.02}) * Transform::rotation({2, 3, -2});
  const Mesh other = moved(mesh, motion);
  Alignment found;
  count([&] { found = align(other, sites); });
  double off = 0;
  for (const Vec3& p : mesh.positions) off = std::max(off, norm(found.transform(motion(p)) - p));
  return found.converged && off < 1e-6;
}

struct Call {
  std::string_view name, words;
  bool (*run)();  ///< returns whether its results are right
};

constexpr Call kCalls[] = {
    {"sites", "`Sites` of the armadillo (52 thousand triangles)", build_sites},
    {"shape", "`Shape` of the armadillo", build_shape},
    {"stored shape", "`Shape` of the same from memory, all of which is checked", read_stored_shape},
    {"atlas", "`Surface` of the camel (20 thousand triangles), 512²", build_surface},
    {"refit", "`Surface::refit` and `Sites::refit` of the armadillo, 256²", refit},
    {"dense map", "`compute_map`, 768², cow to elephant: 70 samples for each of 6 thousand faces", dense_map},
    {"sparse map", "`compute_map`, 192², cow to armadillo: a sample for three of 52 thousand faces",
     sparse_map},
    {"self map", "`compute_map`, 192², the armadillo to itself, faces at a vertex excluded", self_map},
    {"thickness map", "`compute_map`, 192², the thickness of the armadillo by balls", thickness_map},
    {"near points", "`closest_points` of 26 thousand points a hundredth of the size from the armadillo",
     near_points},
    {"far points", "`closest_points` of 50 thousand points in a box of ten times its size", far_points},
    {"remote points", "`closest_points` of 10 thousand points 30 diagonals away", remote_points},
    {"single signs", "`closest_points` and `inside_flags` of one point, 1000 times, armadillo",
     single_signs_of_solid},
    {"single winding signs", "the same of an open armadillo, by winding numbers", single_signs_by_winding},
    {"near signs", "`inside_flags` of the points of `near points`, the first call", near_signs},
    {"separation", "`ProximityQuery::separation` of bunny and armadillo, 200 poses", separation},
    {"penetration depth", "`ProximityQuery::penetration_depth` of elephant and dinosaur, 20 poses",
     penetration_depth},
    {"alignment", "`align` of the camel to itself, moved", alignment},
};

int run(std::string_view name) {
  const auto* const call = std::ranges::find(kCalls, name, &Call::name);
  if (call == std::end(kCalls)) {
    std::fprintf(stderr, "counted_calls: there is no call named %s\n", std::string(name).c_str());
    return 2;
  }
  const ThreadLimit one(1);
  if (call->run()) return 0;
  std::fprintf(stderr, "counted_calls: a result of %s is wrong\n", std::string(name).c_str());
  return 1;
}

}  // namespace
}  // namespace sdm::test

int main(int argc, char** argv) {
  using namespace sdm::test;
  const std::string_view argument = argc == 2 ? argv[1] : "";
  try {
    if (argument != "--list") return run(argument);
    for (const Call& call : kCalls)
      std::printf("%s\t%s\n", std::string(call.name).c_str(), std::string(call.words).c_str());
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "counted_calls: %s\n", error.what());
    return 1;
  }
}
