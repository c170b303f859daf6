#include "proximity/separate/free_translations.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace sdm::separate {
namespace {

constexpr int kMostSteps = 24;
constexpr std::size_t kMostPlanes = 8;
constexpr double kSettled = 1e-3;   // of the length, of a step that is not worth it
constexpr double kMargin = 1e-4;    // of the length, from the planes
constexpr double kTouching = 1e-9;  // of the size, a separation without a direction

// The point of least norm in the half-spaces, by the method of Hildreth: each multiplier in turn is set to
// its best value, until all are settled.
template <class Plane>
Vec3 least_in(std::span<const Plane> planes) {
  std::array<double, kMostPlanes> multiplier{};
  Vec3 t{};
  for (int sweep = 0; sweep < 64; ++sweep) {
    double change = 0;
    for (std::size_t i = 0; i < planes.size(); ++i) {
      const double next = std::max(0.0, multiplier[i] + planes[i].least - dot(planes[i].n, t));
      t += (next - multiplier[i]) * planes[i].n;
      change = std::max(change, std::abs(next - multiplier[i]));
      multiplier[i] = next;
    }
    if (change <= 1e-6 * norm(t)) break;
  }
  return t;
}

}  // namespace

void FreeTranslations::try_direction(const Vec3& u, double shortest) {
  for (const double more : {1.02, 1.25, 1.6, 2.2, 3.2, 5.0, 8.0}) {
    if (!(more * shortest < (1 - kSettled) * length())) return;
    if (try_translation(more * shortest * u)) return;
  }
}

bool FreeTranslations::try_translation(const Vec3& t) {
  if (pair_.collide(t)) return false;
  descend(t);
  return true;
}

// How much of a step there is no collision after: by the separation without a test, or by a few tests.
double FreeTranslations::free_step(const Vec3& t, const Vec3& step, double separation) {
  const double length = norm(step);
  for (const double part : {1.0, 0.5, 0.25})
    if (0.99 * separation >= part * length || !pair_.collide(t + part * step)) return part;
  return std::min(1.0, 0.9 * separation / length);
}

// The closest points of bodies that are apart give a plane for further translations; that of a convex contact
// is exact. Steps to the shortest translation within the planes.
void FreeTranslations::descend(Vec3 t) {
  planes_.clear();
  for (int step = 0; step < kMostSteps; ++step) {
    if (norm(t) < length()) best_ = t;
    const BoundedLength& separation = pair_.separation(t);
    const double gap = separation.value;
    if (!(gap > kTouching * size_)) return;
    const Vec3 n = (1 / gap) * ((*separation.witness)[0] - (*separation.witness)[1]);
    if (planes_.size() == kMostPlanes) planes_.erase(planes_.begin());
    planes_.push_back({n, dot(n, t) - gap + kMargin * norm(t)});
    const Vec3 target = least_in<Plane>(planes_);
    if (!(norm(target) < (1 - kSettled) * norm(t))) return;
    const Vec3 by = target - t;
    t += free_step(t, by, gap) * by;
  }
  if (norm(t) < length()) best_ = t;
}

}  // namespace sdm::separate
