#include "bodies/separate/free_translations.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace sdm::separate {
namespace {

constexpr int kMostSteps = 24;
// After so many translations no further direction is tried, and the bounds stay as far apart as they are.
// Where a separation takes long, as of hundreds of needles at one point, more would take minutes. Fewer do
// where neither body is a solid: the lower bound is 0 then, however short the translation is.
constexpr std::size_t kMostTries = 500, kMostOfSurfaces = 50;
constexpr std::size_t kMostPlanes = 8;
constexpr double kSettled = 1e-3;   // of the length, of a step that is not worth it
constexpr double kMargin = 1e-4;    // of the length, from the planes
constexpr double kTouching = 1e-9;  // of the size, a separation without a direction
// Shortening of a translation along itself: so often at most, until the separation is this fraction of it;
// and the fractions that are tested for.
constexpr int kMostShortened = 16;
constexpr double kClosed = 1e-4;
constexpr std::array kShorter{0.97, 0.99, 0.997};

// The half-space n·t ≥ least.
struct Plane {
  Vec3 n{};
  double least = 0;
};

// The latest half-spaces.
class Planes {
 public:
  void add(const Plane& plane) {
    if (count_ == all_.size()) {
      std::shift_left(all_.begin(), all_.end(), 1);
      --count_;
    }
    all_[count_++] = plane;
  }

  // The point of least norm in all of them, by the method of Hildreth: each multiplier in turn is set to its
  // best value, until all are settled.
  [[nodiscard]] Vec3 least() const {
    std::array<double, kMostPlanes> multiplier{};
    Vec3 t{};
    for (int sweep = 0; sweep < 64; ++sweep) {
      double change = 0;
      for (std::size_t i = 0; i < count_; ++i) {
        const double next = std::max(0.0, multiplier[i] + all_[i].least - dot(all_[i].n, t));
        t += (next - multiplier[i]) * all_[i].n;
        change = std::max(change, std::abs(next - multiplier[i]));
        multiplier[i] = next;
      }
      if (change <= 1e-6 * norm(t)) break;
    }
    return t;
  }

 private:
  std::array<Plane, kMostPlanes> all_{};
  std::size_t count_ = 0;
};

}  // namespace

void FreeTranslations::try_direction(const Vec3& u, double shortest) {
  for (const double more : {1.02, 1.25, 1.6, 2.2, 3.2, 5.0, 8.0}) {
    if (pair_.tries() > (solids_ ? kMostTries : kMostOfSurfaces)) return;
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

// A translation that is shorter by less than the separation is free, too. Where the bodies slide along each
// other, or t leads through a gap between them, shorter ones are found by tests.
Vec3 FreeTranslations::shortened(Vec3 t) {
  for (int step = 0; step < kMostShortened; ++step) {
    const double length = norm(t), gap = pair_.separation(t).value;
    if (gap > std::max(kClosed * length, kTouching * size_)) {
      t = std::max(0.0, 1 - 0.99 * gap / length) * t;
      continue;
    }
    const auto shorter =
        std::ranges::find_if(kShorter, [&](double part) { return !pair_.collide(part * t); });
    if (shorter == kShorter.end()) break;
    t = *shorter * t;
  }
  return t;
}

void FreeTranslations::descend(const Vec3& from) {
  Vec3 t = lowest(from);
  // One that is longer than the best may be shorter than that along itself.
  if (!(norm(t) <= length())) {
    t = ((1 - kSettled) * length() / norm(t)) * t;
    if (pair_.collide(t)) return;
  }
  t = shortened(t);
  if (!pair_.collide(t)) best_ = t;  // steps by separations are not tested
}

// The closest points of bodies that are apart give a plane for further translations; that of a convex contact
// is exact. Steps to the shortest translation within the planes.
Vec3 FreeTranslations::lowest(Vec3 t) {
  Planes planes;
  for (int step = 0; step < kMostSteps; ++step) {
    const BoundedLength& separation = pair_.separation(t);
    const double gap = separation.value;
    if (!(gap > kTouching * size_)) return t;
    const Vec3 n = (1 / gap) * ((*separation.witness)[0] - (*separation.witness)[1]);
    planes.add({n, dot(n, t) - gap + kMargin * norm(t)});
    const Vec3 target = planes.least();
    if (!(norm(target) < (1 - kSettled) * norm(t))) return t;
    const Vec3 by = target - t;
    t += free_step(t, by, gap) * by;
  }
  return t;
}

}  // namespace sdm::separate
