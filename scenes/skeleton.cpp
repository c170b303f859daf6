#include "scenes/skeleton.h"

#include <algorithm>

namespace sdm::scenes {
namespace {

constexpr double kBlend = 0.012;  // in metres: the width over which muscles are blended

double distance(const Muscle& muscle, const Vec3& p) {
  const Vec3 along = muscle.end - muscle.begin;
  const double t = std::clamp(dot(p - muscle.begin, along) / squared_norm(along), 0.0, 1.0);
  return norm(p - muscle.begin - t * along) - ((1 - t) * muscle.begin_radius + t * muscle.end_radius);
}

}  // namespace

// The smooth minimum −k log Σ exp(−d/k); exponents are relative to the smallest distance.
double skin_distance(const Skeleton& skeleton, const Vec3& p) {
  double least = kInfinity;
  for (const Muscle& muscle : skeleton.muscles) least = std::min(least, distance(muscle, p));
  double sum = 0;
  for (const Muscle& muscle : skeleton.muscles) sum += std::exp((least - distance(muscle, p)) / kBlend);
  return least - kBlend * std::log(sum);
}

std::vector<Motion> pose(const Skeleton& skeleton, std::span<const Matrix> rotations) {
  std::vector<Motion> motions;
  for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
    const Bone& bone = skeleton.bones[b];
    const Motion turn{rotations[b], bone.joint - rotations[b] * bone.joint};
    motions.push_back(b == 0 ? turn : motions[bone.parent] * turn);
  }
  return motions;
}

// The weights are those of the blend in skin_distance, so that a bone moves the part of the surface that its
// muscle shapes.
Skin::Skin(const Skeleton& skeleton, std::span<const Vec3> rest) : rest_(rest.begin(), rest.end()) {
  for (const Vec3& p : rest_) {
    double least = kInfinity, sum = 0;
    for (const Muscle& muscle : skeleton.muscles) least = std::min(least, distance(muscle, p));
    std::vector<double>& weights = weights_.emplace_back(skeleton.bones.size(), 0.0);
    for (const Muscle& muscle : skeleton.muscles) {
      const double weight = std::exp((least - distance(muscle, p)) / kBlend);
      weights[muscle.bone] += weight;
      sum += weight;
    }
    for (double& weight : weights) weight /= sum;
  }
}

void Skin::move(std::span<const Motion> motions, std::vector<Vec3>& positions) const {
  positions.assign(rest_.size(), Vec3{});
  for (std::size_t v = 0; v < rest_.size(); ++v)
    for (std::size_t b = 0; b < motions.size(); ++b)
      if (weights_[v][b] > 0) positions[v] += weights_[v][b] * motions[b](rest_[v]);
}

}  // namespace sdm::scenes
