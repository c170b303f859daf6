#include "proximity/sampled/pair_answers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/geometry/vec.h"
#include "core/parallel.h"
#include "engine/cpu/cpu_engine.h"
#include "proximity/exact/collision.h"

namespace sdm::sampled {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

}  // namespace

void PairAnswers::begin(const Body& o1, const Body& o2) {
  bodies_ = {&o1, &o2};
  Box box = o1.box();
  extend(box, o2.box());
  precision_ = 1e-6 * diagonal(box);
  measured_ = depth_found_ = false;
  closest_.reset(), intersection_.reset(), separation_.reset(), depth_.reset(), colliding_.reset(),
      contacts_.reset();
}

const BoundedLength& PairAnswers::separation() {
  if (!separation_) separation_ = options_.exact ? exact_separation() : bounded_separation();
  return *separation_;
}

BoundedBool PairAnswers::colliding() {
  if (!colliding_)
    colliding_ = {surfaces_intersect() || exact::one_contains_part_of_other(meshes()), Certainty::exact};
  return *colliding_;
}

const std::optional<BoundedLength>& PairAnswers::penetration_depth() {
  if (!std::exchange(depth_found_, true)) depth_ = depth();
  return depth_;
}

std::span<const Contact> PairAnswers::contacts() {
  measure();
  if (!contacts_) {
    const std::array<MeasuredBody, 2> measured{MeasuredBody{*bodies_[0], distances_[0]},
                                               MeasuredBody{*bodies_[1], distances_[1]}};
    contacts_ = finder_.find(measured, options_.contact_margin, precision_);
  }
  return *contacts_;
}

std::size_t PairAnswers::samples_used() const {
  std::size_t sum = 0;
  for (const LocalDistances& measured : distances_) sum += measured.distances().size();
  return sum;
}

void PairAnswers::measure() {
  if (std::exchange(measured_, true)) return;
  for (int b = 0; b < 2; ++b) distances_[b].start(*bodies_[b], *bodies_[1 - b]);
  for (const std::size_t blocks_per_probe : LocalDistances::kBlocksPerProbe) {
    for (LocalDistances& distances : distances_) distances.probe(blocks_per_probe);
    // Samples nearer than this affect contacts, depth and, unless it is computed from the triangles,
    // separation.
    double reach = options_.contact_margin;
    if (!options_.exact)
      reach = std::max(reach, std::min(distances_[0].least_probed(), distances_[1].least_probed()));
    for (LocalDistances& distances : distances_) distances.keep(reach + precision_);
  }
  for (LocalDistances& distances : distances_) distances.measure();
}

// The minimum of value(distance, covering radius) over all measured samples, and its sample.
template <class Value>
std::pair<double, PairAnswers::Sample> PairAnswers::least(const Value& value) const {
  std::pair<double, Sample> least{kNoLimit, {}};
  for (int b = 0; b < 2; ++b) {
    const std::span<const float> distances = distances_[b].distances(), radii = distances_[b].radii();
    for (std::size_t i = 0; i < distances.size(); ++i)
      if (const double v = value(distances[i], radii[i]); v < least.first) least = {v, {b, i}};
  }
  return least;
}

// The sample and the closest point on the other body.
std::optional<std::array<Vec3, 2>> PairAnswers::witness(const Sample& sample) const {
  if (sample.index == kNone) return {};
  const Vec3& p = distances_[sample.body].points()[sample.index];
  Vec3 q = p;
  cpu::cpu_search(internals(bodies_[1 - sample.body]->sites()), {&p, 1}, kNoLimit,
                  [&](std::size_t, const sites::ClosestPacket& closest) { q = closest.get(0, p).point; });
  return sample.body == 0 ? std::array{p, q} : std::array{q, p};
}

exact::MeshPair PairAnswers::meshes() const {
  return {internals(bodies_[0]->sites()), internals(bodies_[1]->sites())};
}

const exact::Separation& PairAnswers::closest_triangles() {
  if (!closest_) closest_ = exact::find_closest(meshes(), kNoLimit, workspace_);
  return *closest_;
}

BoundedLength PairAnswers::exact_separation() {
  const exact::Separation& c = closest_triangles();
  return {.value = c.distance,
          .certainty = Certainty::exact,
          .lower = c.distance,
          .upper = c.distance,
          .witness = std::array{c.point1, c.point2}};
}

// Decided exactly, by the closest triangles if they are known.
bool PairAnswers::surfaces_intersect() {
  if (closest_ || options_.exact) return closest_triangles().intersecting;
  if (!intersection_) intersection_ = exact::find_intersection(meshes(), workspace_);
  return intersection_->intersecting;
}

BoundedLength PairAnswers::bounded_separation() {
  measure();
  const auto [value, sample] = least([](double d, double) { return std::abs(d); });
  const double lower = least([](double d, double radius) { return std::abs(d) - radius; }).first;
  if (lower <= precision_ && surfaces_intersect())
    return {.certainty = Certainty::exact,
            .witness = std::array{intersection_->point1, intersection_->point2}};
  return {.value = value,
          .certainty = Certainty::bounded,
          .lower = std::max(0.0, lower - precision_),
          .upper = value + precision_,
          .witness = witness(sample)};
}

std::optional<BoundedLength> PairAnswers::depth() {
  if (!bodies_[0]->solid() && !bodies_[1]->solid()) return {};
  if (!colliding().value) return BoundedLength{.certainty = Certainty::exact};
  return bounded_depth();
}

BoundedLength PairAnswers::bounded_depth() {
  measure();
  Depth deepest;
  for (int b = 0; b < 2; ++b) deepest = deeper(deepest, depth_at_faces(b));
  for (int b = 0; b < 2; ++b)
    if (!distances_[b].buried().empty()) deepest = deeper(deepest, depth_of_buried(b, deepest));
  return {.value = std::max(0.0, deepest.value),
          .certainty = Certainty::bounded,
          .lower = std::max(0.0, deepest.lower - precision_),
          .upper = std::max(0.0, deepest.upper + precision_),
          .witness = deepest.points};
}

PairAnswers::Depth PairAnswers::deeper(const Depth& a, const Depth& b) {
  Depth result = b.lower > a.lower ? b : a;
  result.upper = std::max(a.upper, b.upper);
  return result;
}

// Over the samples whose closest faces are part of the boundary.
PairAnswers::Depth PairAnswers::depth_at_faces(int body) const {
  const LocalDistances& on = distances_[body];
  const std::span<const float> distances = on.distances(), radii = on.radii();
  Depth deepest;
  Sample sample{.body = body};
  std::span<const std::uint32_t> buried = on.buried();
  for (std::uint32_t i = 0; i < distances.size(); ++i) {
    if (!buried.empty() && buried.front() == i) {
      buried = buried.subspan(1);
      continue;
    }
    deepest.upper = std::max(deepest.upper, double{radii[i]} - distances[i]);
    if (-distances[i] > deepest.lower) deepest.lower = deepest.value = -distances[i], sample.index = i;
  }
  deepest.points = witness(sample);
  return deepest;
}

// Over the other samples, as far as they may be deeper than `known`. Distances to the boundary are
// 1-Lipschitz: samples every kStrides[0] tell which others need to be measured, these which more.
PairAnswers::Depth PairAnswers::depth_of_buried(int body, Depth known) {
  constexpr std::array<std::size_t, 3> kStrides{64, 8, 1};
  const Body& solid = *bodies_[1 - body];
  solid.require_boundary();
  const LocalDistances& on = distances_[body];
  const std::span<const std::uint32_t> samples = on.buried();
  std::vector<std::optional<inside::SolidBoundary::Closest>>& closest = closest_boundary_;
  closest.assign(samples.size(), {});
  Depth deepest;
  for (const std::size_t stride : kStrides) {
    const std::size_t coarser = stride == kStrides[0] ? 0 : 8 * stride;  // decided before
    parallel_for((samples.size() + stride - 1) / stride, 8, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const std::size_t i = k * stride;
        const Vec3& p = on.points()[samples[i]];
        if (coarser > 0) {
          if (i % coarser == 0) continue;
          const std::size_t before =
              closest[i / coarser * coarser] ? i / coarser * coarser : i / kStrides[0] * kStrides[0];
          const double most = closest[before]->upper + norm(p - on.points()[samples[before]]);
          if (most <= known.lower && most + on.radii()[samples[i]] <= known.upper) continue;
        }
        closest[i] = solid.boundary().closest(p);
      }
    });
    for (std::size_t i = 0; i < samples.size(); i += stride) {
      if (!closest[i]) continue;
      const auto& [lower, upper, point] = *closest[i];
      const Vec3& p = on.points()[samples[i]];
      Depth here{.lower = lower, .value = point ? upper : lower, .upper = upper + on.radii()[samples[i]]};
      if (point) here.points = body == 0 ? std::array{p, *point} : std::array{*point, p};
      deepest = deeper(deepest, here);
    }
    known = deeper(known, deepest);
  }
  return deepest;
}

}  // namespace sdm::sampled
