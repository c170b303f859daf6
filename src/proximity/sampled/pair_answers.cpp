#include "proximity/sampled/pair_answers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/geometry/vec.h"
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
  closest_.reset(), separation_.reset(), depth_.reset(), colliding_.reset(), contacts_.reset();
}

const BoundedLength& PairAnswers::separation() {
  if (!separation_) separation_ = options_.exact ? exact_separation() : bounded_separation();
  return *separation_;
}

BoundedBool PairAnswers::colliding() {
  if (!colliding_) colliding_ = options_.exact ? exact_collision() : sampled_collision();
  return *colliding_;
}

const std::optional<BoundedLength>& PairAnswers::penetration_depth() {
  if (!std::exchange(depth_found_, true)) depth_ = depth();
  return depth_;
}

std::span<const Contact> PairAnswers::contacts() {
  measure();
  if (!contacts_) {
    const std::array<MeasuredBody, 2> measured{
        MeasuredBody{bodies_[0]->surface(), bodies_[0]->sites(), distances_[0]},
        MeasuredBody{bodies_[1]->surface(), bodies_[1]->sites(), distances_[1]}};
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

BoundedBool PairAnswers::exact_collision() {
  return {closest_triangles().intersecting || exact::one_contains_part_of_other(meshes()), Certainty::exact};
}

BoundedLength PairAnswers::bounded_separation() {
  measure();
  const auto [value, sample] = least([](double d, double) { return std::abs(d); });
  const double lower = least([](double d, double radius) { return std::abs(d) - radius; }).first;
  return {.value = value,
          .certainty = Certainty::bounded,
          .lower = std::max(0.0, lower - precision_),
          .upper = value + precision_,
          .witness = witness(sample)};
}

BoundedBool PairAnswers::sampled_collision() {
  measure();
  if (least([](double d, double) { return d; }).first < -precision_) return {true, Certainty::exact};
  if (separation().lower > 0) return {false, Certainty::exact};
  return {true, Certainty::estimate};  // the samples cannot distinguish this from contact
}

std::optional<BoundedLength> PairAnswers::depth() {
  if (!bodies_[0]->solid() && !bodies_[1]->solid()) return {};
  if (options_.exact && !colliding().value) return BoundedLength{.certainty = Certainty::exact};
  return bounded_depth();
}

BoundedLength PairAnswers::bounded_depth() {
  measure();
  const auto [value, sample] = least([](double d, double) { return d; });
  const double most = -least([](double d, double radius) { return d - radius; }).first;
  BoundedLength found{.certainty = Certainty::bounded, .upper = std::max(0.0, most + precision_)};
  if (value < 0) {
    found.value = -value;
    found.lower = std::max(0.0, found.value - precision_);
    found.witness = witness(sample);
  }
  return found;
}

}  // namespace sdm::sampled
