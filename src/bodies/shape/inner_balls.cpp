#include "bodies/shape/inner_balls.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "closest/single_point.h"
#include "geometry/vec.h"

namespace sdm::shape {
namespace {

constexpr std::size_t kSamples = 96;
constexpr std::size_t kSurface = 3;  // one point of the surface for so many samples
constexpr int kMostSteps = 12;
constexpr double kSettled = 1e-3;  // of the radius
constexpr double kSame = 0.25;     // balls with centres as near, relative to the larger radius, are one

struct Sample {
  Vec3 at{}, inward{};
};

// The k-th of kSamples points, by the additive sequence of Roberts in each face.
Sample sample_of(const sites::SitesData& sites, std::size_t k) {
  const std::size_t faces = sites.tree.items.size();
  const std::uint32_t face = sites.tree.items[(2 * k + 1) * faces / (2 * kSamples)];
  const auto n = static_cast<double>(k);
  double u = std::fmod(0.5 + 0.7548776662466927 * n, 1), v = std::fmod(0.5 + 0.5698402909980532 * n, 1);
  if (u + v > 1) {
    u = 1 - u;
    v = 1 - v;
  }
  const auto& [i, j, l] = sites.mesh.triangles[face];
  const Vec3 &a = sites.mesh.positions[i], &b = sites.mesh.positions[j], &c = sites.mesh.positions[l];
  const Vec3 normal = normalized(cross(b - a, c - a));
  return {a + u * (b - a) + v * (c - a), sites.inverted[face] != 0 ? normal : -normal};
}

std::optional<Ball> ball_at(const sites::SitesData& sites, const inside::InsideTest& inside,
                            const Sample& sample, double largest) {
  double radius = largest;
  for (int step = 0; step < kMostSteps; ++step) {
    const Vec3 centre = sample.at + radius * sample.inward;
    const ClosestPoint closest = closest::closest_point(sites, centre, kInfinity);
    if (closest.distance >= (1 - kSettled) * radius || step + 1 == kMostSteps) {
      if (closest.distance == 0 || !inside(centre, closest)) return {};
      return Ball{centre, closest.distance};
    }
    const Vec3 to = closest.point - sample.at;
    const double touching = squared_norm(to) / (2 * dot(to, sample.inward));
    radius = touching > 0 && touching < radius ? touching : 0.5 * radius;
  }
  return {};
}

}  // namespace

InnerBalls inner_balls(const sites::SitesData& sites, const inside::InsideTest& inside) {
  InnerBalls result;
  const double largest = 0.5 * diagonal(bounds(sites.mesh));
  std::vector<Ball> found;
  for (std::size_t k = 0; k < kSamples; ++k) {
    const Sample sample = sample_of(sites, k);
    if (k % kSurface == 0) result.surface.push_back(sample.at);
    if (!sites.is_solid()) continue;
    if (const std::optional<Ball> ball = ball_at(sites, inside, sample, largest)) found.push_back(*ball);
  }
  std::ranges::stable_sort(found, std::ranges::greater{}, &Ball::radius);
  for (const Ball& ball : found)
    if (std::ranges::none_of(result.balls, [&](const Ball& kept) {
          return norm(ball.centre - kept.centre) < kSame * kept.radius;
        }))
      result.balls.push_back(ball);
  return result;
}

}  // namespace sdm::shape
