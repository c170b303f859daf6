// A square cloth falls over a ball and comes to rest on it: contacts from the closest points of its vertices.
#include <sdm/sdm.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace {

using sdm::Vec3;

// A ball of radius 0.5: rings of latitude between two poles.
sdm::Mesh ball() {
  constexpr std::uint32_t kRings = 23, kSides = 48;
  sdm::Mesh mesh;
  for (std::uint32_t r = 1; r <= kRings; ++r)
    for (std::uint32_t k = 0; k < kSides; ++k) {
      const double polar = std::numbers::pi * r / (kRings + 1), around = 2 * std::numbers::pi * k / kSides;
      mesh.positions.push_back({0.5 * std::sin(polar) * std::cos(around),
                                0.5 * std::sin(polar) * std::sin(around), 0.5 * std::cos(polar)});
    }
  const auto top = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {{0, 0, 0.5}, {0, 0, -0.5}});
  for (std::uint32_t k = 0; k < kSides; ++k) {
    const std::uint32_t next = (k + 1) % kSides, last = (kRings - 1) * kSides;
    mesh.triangles.insert(mesh.triangles.end(), {{top, k, next}, {top + 1, last + next, last + k}});
    for (std::uint32_t a = 0; a < last; a += kSides)
      mesh.triangles.insert(mesh.triangles.end(), {{a + k, a + kSides + k, a + kSides + next},
                                                   {a + k, a + kSides + next, a + next}});
  }
  return mesh;
}

}  // namespace

int main() {
  constexpr std::size_t kSide = 41;
  constexpr double kWidth = 1.6, kTime = 1.0 / 600, kGravity = 9.81, kThickness = 0.01, kFriction = 0.5;
  const sdm::Sites body(ball());

  std::vector<Vec3> places, velocities(kSide * kSide);
  for (std::size_t i = 0; i < kSide * kSide; ++i) {
    const auto along = [](std::size_t k) { return kWidth * (static_cast<double>(k) / (kSide - 1) - 0.5); };
    places.push_back({along(i % kSide), along(i / kSide), 0.6});
  }
  // Springs to the next vertices along rows, columns and diagonals, and to those after them against bending.
  struct Spring {
    std::size_t a, b;
    double length;
  };
  std::vector<Spring> springs;
  for (const auto& [x, y] : {std::array{1, 0}, {0, 1}, {1, 1}, {1, -1}, {2, 0}, {0, 2}})
    for (int j = std::max(0, -y); j + std::max(0, y) < static_cast<int>(kSide); ++j)
      for (int i = 0; i + x < static_cast<int>(kSide); ++i) {
        const auto a = static_cast<std::size_t>(j) * kSide + static_cast<std::size_t>(i);
        const auto b = static_cast<std::size_t>(j + y) * kSide + static_cast<std::size_t>(i + x);
        springs.push_back({a, b, norm(places[a] - places[b])});
      }

  for (int step = 1; step <= 1800; ++step) {
    const std::vector<Vec3> before = places;
    for (std::size_t i = 0; i < places.size(); ++i)
      places[i] = places[i] + (0.998 * kTime) * velocities[i] - Vec3{0, 0, kTime * kTime * kGravity};
    for (const auto& [a, b, length] : springs) {  // half of the change for each end
      const Vec3 along = places[b] - places[a];
      const Vec3 change = (0.5 - 0.5 * length / norm(along)) * along;
      places[a] = places[a] + change;
      places[b] = places[b] - change;
    }
    // Vertices nearer than the thickness are pushed out, and slide against friction.
    const std::vector<sdm::ClosestPoint> closest = sdm::closest_points(body, places);
    const std::vector<std::uint8_t> inside = sdm::inside_flags(body, places, closest, sdm::SignMethod::exact);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double height = (inside[i] ? -1 : 1) * closest[i].distance;
      if (height >= kThickness || closest[i].distance == 0) continue;
      const Vec3 normal = (1 / height) * (places[i] - closest[i].point);
      places[i] = places[i] + (kThickness - height) * normal;
      const Vec3 moved = places[i] - before[i];
      const double out = moved[0] * normal[0] + moved[1] * normal[1] + moved[2] * normal[2];
      const Vec3 slide = moved - out * normal;
      const double length = norm(slide);
      if (length > 0)
        places[i] = places[i] - (std::min(1.0, kFriction * (kThickness - height) / length)) * slide;
    }
    double fastest = 0, lowest = 1, nearest = 1;
    for (std::size_t i = 0; i < places.size(); ++i) {
      velocities[i] = (1 / kTime) * (places[i] - before[i]);
      fastest = std::max(fastest, norm(velocities[i]));
      lowest = std::min(lowest, places[i][2]);
    }
    if (step % 600 != 0) continue;
    const std::vector<sdm::ClosestPoint> now = sdm::closest_points(body, places);
    const std::vector<std::uint8_t> in = sdm::inside_flags(body, places, now, sdm::SignMethod::exact);
    for (std::size_t i = 0; i < places.size(); ++i)
      nearest = std::min(nearest, (in[i] ? -1 : 1) * now[i].distance);
    std::printf("step %4d: lowest %.2f, fastest %.2f, nearest to the ball %.4f\n", step, lowest, fastest,
                nearest);
  }
}
