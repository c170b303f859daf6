// Thirty discs on a circle change sides: each steers by its distance map to the others, and moves less than
// half of its separation from them, so that none ever touches another.
#include <sdm/sdm.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace {

using sdm::Vec3;

// A disc of radius 0.3 and height 0.2.
sdm::Mesh disc() {
  constexpr std::uint32_t kSides = 16;
  sdm::Mesh mesh{{{0, 0, 0}, {0, 0, 0.2}}, {}, {}};
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSides;
    for (const double z : {0.0, 0.2})
      mesh.positions.push_back({0.3 * std::cos(angle), 0.3 * std::sin(angle), z});
    const std::uint32_t a = 2 + 2 * i, b = 2 + 2 * ((i + 1) % kSides);
    mesh.triangles.insert(mesh.triangles.end(),
                          {{0, b, a}, {1, a + 1, b + 1}, {a, b, b + 1}, {a, b + 1, a + 1}});
  }
  return mesh;
}

}  // namespace

int main() {
  constexpr std::size_t kDiscs = 30;
  constexpr double kCircle = 5, kNear = 1, kTime = 1.0 / 60, kSpeed = 1;
  const sdm::Shape shape(disc(), {.resolution = 32});  // with an atlas, for maps
  sdm::MultiBodyQuery query(std::vector<sdm::Shape>(kDiscs, shape));
  std::vector<Vec3> places, goals;
  for (std::size_t i = 0; i < kDiscs; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / kDiscs, to = angle + 2.8;
    places.push_back({kCircle * std::cos(angle), kCircle * std::sin(angle), 0});
    goals.push_back({kCircle * std::cos(to), kCircle * std::sin(to), 0});
  }

  std::vector<sdm::Transform> poses(kDiscs);
  sdm::NearestMap nearest;
  double closest = 1;
  for (int frame = 1; frame <= 900; ++frame) {
    for (std::size_t i = 0; i < kDiscs; ++i) poses[i] = sdm::Transform::translation(places[i]);
    query.set_poses(poses);
    std::vector<double> separation(kDiscs, 1);
    for (const sdm::PairSeparation& pair : query.separations(kNear))
      for (const std::uint32_t i : {pair.first, pair.second})
        separation[i] = std::min(separation[i], pair.separation.value);

    for (std::size_t i = 0; i < kDiscs; ++i) {
      // Towards the goal, away from what is close, and past it on one side.
      const double dx = goals[i][0] - places[i][0], dy = goals[i][1] - places[i][1],
                   left = std::hypot(dx, dy);
      double x = dx / std::max(left, 1.0), y = dy / std::max(left, 1.0);
      query.nearest_map(i, kNear, nearest);
      for (const std::uint32_t texel : shape.surface().sample_texels()) {
        if (nearest.body[texel] == sdm::kNone) continue;
        const auto& [vx, vy, vz] = nearest.map.vector[texel];
        const double across = std::max(std::hypot(vx, vy), 1e-6f),
                     weight = 0.1 * std::exp(-across / 0.15) / across;
        x += weight * (-vx + vy);
        y += weight * (-vy - vx);
      }
      const double speed = std::hypot(x, y), wanted = kTime * std::min(kSpeed, speed);
      const double step = std::min(wanted, 0.45 * separation[i]) / std::max(speed, 1e-9);
      places[i][0] += step * x;
      places[i][1] += step * y;
      closest = std::min(closest, separation[i]);
    }

    if (frame % 300 != 0) continue;
    std::size_t arrived = 0;
    for (std::size_t i = 0; i < kDiscs; ++i)
      arrived += std::hypot(goals[i][0] - places[i][0], goals[i][1] - places[i][1]) < 0.5;
    std::printf("frame %4d: %zu discs at their goals, never closer than %.3f\n", frame, arrived, closest);
  }
}
