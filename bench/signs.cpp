// What signs cost beside closest points, for closed and open meshes and soups: processor time of one thread,
// of the first call after Sites, which makes what signs need, and of later ones. Signs of some points are
// first compared with the sum of all solid angles.
//
//   build/dev/bench/signs [--list] [--filter REGEX] [--repetitions N] [--json FILE]
#include <sdm/closest_points.h>
#include <sdm/execution.h>
#include <sdm/map.h>
#include <sdm/sites.h>

#include <cmath>
#include <ctime>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "harness.h"
#include "inside/angles/solid_angle.h"
#include "point_sets.h"
#include "refine_mesh.h"
#include "scenes.h"
#include "sites/sites_data.h"
#include "timing.h"

namespace sdm::bench {
namespace {

double processor_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}
template <class Work>
double milliseconds_of(const Work& work) {
  const double begin = processor_ms();
  work();
  return processor_ms() - begin;
}

// The winding number of the faces as they are oriented.
double winding_number(const Sites& sites, const Vec3& q) {
  const sites::SitesData& data = internals(sites);
  double sum = 0;
  for (std::size_t f = 0; f < data.mesh.triangles.size(); ++f) {
    if (data.topology.ignored(f)) continue;
    const auto& [a, b, c] = data.mesh.triangles[f];
    const auto& p = data.mesh.positions;
    const double angle = inside::solid_angle(p[a] - q, p[b] - q, p[c] - q);
    sum += data.inverted[f] != 0 ? -angle : angle;
  }
  return sum / (4 * std::numbers::pi);
}

bool verify(const Sites& sites, const std::vector<Vec3>& points, SignMethod method) {
  const std::vector<ClosestPoint> closest = closest_points(sites, points);
  const std::vector<std::uint8_t> inside = inside_flags(sites, points, closest, method);
  for (std::size_t i = 0; i < points.size(); i += 1 + points.size() / 50) {
    const double number = winding_number(sites, points[i]);
    const double margin = std::abs(method == SignMethod::exact ? std::abs(number) - 0.5 : number - 0.5);
    if (closest[i].distance < 1e-6 || margin < 1e-6) continue;
    const bool expected = method == SignMethod::exact ? std::abs(number) > 0.5 : number > 0.5;
    if ((inside[i] != 0) != expected) return false;
  }
  return true;
}

// Milliseconds of unsigned results, and of signed ones: the first and later ones.
struct Times {
  std::vector<double> none, first, later;

  [[nodiscard]] std::vector<Figure> figures(double count) const {
    const double us = 1e3 / count;
    return {{"unsigned_us", us * median(none)},
            {"first_ratio", median(first) / median(none)},
            {"later_ratio", median(later) / median(none)},
            {"sign_us", us * (median(later) - median(none))}};
  }
};
// `make` makes Sites; `query` takes these and a method.
template <class Make, class Query>
Times take_times(int repetitions, SignMethod method, const Make& make, const Query& query) {
  Times times;
  for (int i = 0; i < repetitions; ++i) {
    const Sites sites = make();
    query(sites, SignMethod::none);  // its memory
    times.none.push_back(milliseconds_of([&] { query(sites, SignMethod::none); }));
    times.first.push_back(milliseconds_of([&] { query(sites, method); }));
    times.later.push_back(milliseconds_of([&] { query(sites, method); }));
  }
  return times;
}

void query_points(const Sites& sites, const std::vector<Vec3>& points, SignMethod method) {
  const std::vector<ClosestPoint> closest = closest_points(sites, points);
  if (method != SignMethod::none) (void)inside_flags(sites, points, closest, method);
}

Outcome points_case(const Trial& trial, const Mesh& mesh, SignMethod method, std::size_t count) {
  const ThreadLimit limit(1);
  Outcome outcome{.verified = true};
  const Sites sites(mesh);
  for (const PointSet& set : point_sets()) {
    const std::string name = set.name;
    if (name.starts_with("map") || name == "far" || name == "remote") continue;
    const std::vector<Vec3> points = set.points(mesh, count);
    outcome.verified = outcome.verified && verify(sites, points, method);
    const Times times = take_times(
        trial.repetitions, method, [&] { return Sites(mesh); },
        [&](const Sites& fresh, SignMethod sign) { query_points(fresh, points, sign); });
    outcome.rows.push_back({name, times.figures(static_cast<double>(points.size()))});
  }
  return outcome;
}

// Points asked for one at a time, as in a loop of a script.
Outcome single_points_case(const Trial& trial, const Mesh& mesh, SignMethod method, std::size_t count) {
  const ThreadLimit limit(1);
  const Sites sites(mesh);
  const std::vector<Vec3> points = points_around_box(mesh, count);
  const auto one_by_one = [&](const Sites& of, SignMethod sign) {
    for (const Vec3& p : points) query_points(of, {p}, sign);
  };
  const Times times = take_times(
      trial.repetitions, method, [&] { return Sites(mesh); }, one_by_one);
  return {.verified = verify(sites, points, method),
          .rows = {{"", times.figures(static_cast<double>(points.size()))}}};
}

Outcome map_case(const Trial& trial, const Mesh& o1, const Mesh& o2, SignMethod method) {
  const ThreadLimit limit(1);
  const Surface surface(o1, {.resolution = 512});
  const std::vector<Vec3> points = surface.sample_points();
  DistanceMap map;
  const Times times = take_times(
      trial.repetitions, method, [&] { return Sites(o2); },
      [&](const Sites& sites, SignMethod sign) { compute_map(surface, sites, {.sign = sign}, map); });
  return {.verified = verify(Sites(o2), points, method),
          .rows = {{"", times.figures(static_cast<double>(points.size()))}}};
}

// Without its lowest part, by the heights of faces.
Mesh opened(Mesh mesh) {
  const Box box = bounds(mesh);
  const double least = box.lower[2] + 0.1 * (box.upper[2] - box.lower[2]);
  std::erase_if(mesh.triangles, [&](const Triangle& t) { return mesh.positions[t[0]][2] < least; });
  return mesh;
}
// Triangles with corners of their own, not quite where they were.
Mesh soup(const Mesh& mesh) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> noise(-1e-4, 1e-4);
  Mesh result;
  for (const Triangle& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(result.positions.size());
    for (const std::uint32_t v : t)
      result.positions.push_back(mesh.positions[v] + Vec3{noise(random), noise(random), noise(random)});
    result.triangles.push_back({first, first + 1, first + 2});
  }
  return result;
}

Mesh armadillo(std::uint32_t parts) {
  return refine_mesh(load("armadillo.off", "fit"), parts, parts > 1 ? 0.1 : 0);
}

struct Shape {
  const char *name, *description;
  SignMethod method;
  Mesh (*of)(const Mesh& mesh);
};
constexpr Shape kShapes[] = {
    {"closed", "closed", SignMethod::exact, [](const Mesh& mesh) { return mesh; }},
    {"open", "without its lowest tenth", SignMethod::winding, [](const Mesh& mesh) { return opened(mesh); }},
    {"soup", "as separate triangles", SignMethod::winding, [](const Mesh& mesh) { return soup(mesh); }},
};

std::vector<Case> cases() {
  std::vector<Case> result;
  for (const Shape& shape : kShapes)
    for (const std::uint32_t parts : {1u, 5u})
      for (const std::size_t count : {1000u, 100'000u})
        result.push_back(
            {.name = std::string(shape.name) + (parts == 1 ? "-52k-" : "-1.3m-") + std::to_string(count),
             .description = std::to_string(count) + " points; an armadillo " + shape.description,
             .run =
                 [=](const Trial& trial) {
                   return points_case(trial, shape.of(armadillo(parts)), shape.method, count);
                 },
             .repetitions = parts == 1 ? 5 : 3});
  for (const Shape& shape : kShapes)
    for (const std::uint32_t parts : {1u, 5u})
      result.push_back({.name = std::string(shape.name) + (parts == 1 ? "-52k" : "-1.3m") + "-single",
                        .description = std::string("5000 points, each by a call of its own; an armadillo ") +
                                       shape.description,
                        .run =
                            [=](const Trial& trial) {
                              return single_points_case(trial, shape.of(armadillo(parts)), shape.method,
                                                        5000);
                            },
                        .repetitions = 3});
  for (const char* name : {"armadillo.off", "elephant.off", "cow.off", "bunny.obj"})
    for (const Shape& shape : kShapes)
      result.push_back(
          {.name = std::string(shape.name) + "-self-" + std::string(name, std::string(name).find('.')),
           .description = "the map of a mesh to itself, " + std::string(shape.description),
           .run =
               [=](const Trial& trial) {
                 const Mesh mesh = load(name, "fit");
                 const Mesh o2 = shape.of(mesh);
                 const bool solid = internals(Sites(o2)).is_solid();
                 return map_case(trial, mesh, o2, solid ? SignMethod::exact : SignMethod::winding);
               },
           .repetitions = 3});
  for (const Shape& shape : kShapes)
    result.push_back({.name = std::string(shape.name) + "-map",
                      .description = "the map of a cow to an armadillo, " + std::string(shape.description),
                      .run =
                          [=](const Trial& trial) {
                            return map_case(trial, load("cow.off", "fit"), shape.of(armadillo(1)),
                                            shape.method);
                          },
                      .repetitions = 3});
  return result;
}

}  // namespace

Program program() {
  return {.name = "signs",
          .description = "What signs cost beside closest points",
          .repetition = "repetitions",
          .cases = cases()};
}

}  // namespace sdm::bench
