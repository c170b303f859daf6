#include "proximity/sampled/pair_answers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/geometry/sweep.h"
#include "core/geometry/vec.h"
#include "core/parallel.h"
#include "engine/cpu/cpu_engine.h"
#include "proximity/exact/collision.h"

namespace sdm::sampled {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

}  // namespace

void PairAnswers::begin(const PosedBody& o1, const PosedBody& o2, const FacePair& hint) {
  bodies_ = {&o1, &o2};
  closest_faces_ = hint;
  for (int b = 0; b < 2; ++b) {
    const proximity::Similarity &from = bodies_[b]->pose(), &to = bodies_[1 - b]->pose();
    to_other_[b] = {inverse(to.map) * from.map, from.scale / to.scale};
  }
  Box box = o1.box();
  extend(box, o2.box());
  precision_ = 1e-6 * diagonal(box);
  measured_ = Measured::nothing, depth_found_ = false;
  intersecting_.reset(), separation_.reset(), depth_.reset(), colliding_.reset(), contacts_.reset();
}

const BoundedLength& PairAnswers::separation() {
  if (!separation_) find_closest(kNoLimit);
  return *separation_;
}

BoundedBool PairAnswers::colliding() {
  if (!colliding_)
    colliding_ = {box_distance(bodies_[0]->box(), bodies_[1]->box()) == 0 &&
                      (surfaces_intersect() || exact::one_contains_part_of_other(meshes())),
                  Certainty::exact};
  return *colliding_;
}

const std::optional<BoundedLength>& PairAnswers::penetration_depth() {
  if (!std::exchange(depth_found_, true)) depth_ = depth();
  return depth_;
}

std::span<const Contact> PairAnswers::contacts() {
  if (!contacts_ && !within(contact_margin_)) contacts_ = std::span<const Contact>();
  if (!contacts_) {
    measure(Measured::all);
    const std::array<MeasuredBody, 2> measured{MeasuredBody{*bodies_[0], distances_[0]},
                                               MeasuredBody{*bodies_[1], distances_[1]}};
    contacts_ = finder_.find(measured, contact_margin_, precision_);
  }
  return *contacts_;
}

std::size_t PairAnswers::samples_used() const {
  if (measured_ == Measured::nothing) return 0;
  return distances_[0].distances().size() + distances_[1].distances().size();
}

// Marks the blocks that may hold the deepest point, with the same result whichever samples are measured:
// blocks that only contacts need are no deeper than those that are marked.
void PairAnswers::measure(Measured samples) {
  if (measured_ >= samples) return;
  measured_ = samples;
  const auto unit = [&](int body) { return bodies_[1 - body]->pose().scale; };
  for (int b = 0; b < 2; ++b) distances_[b].start(bodies_[b]->body(), bodies_[1 - b]->body(), to_other_[b]);
  double deepest = 0;
  for (const std::size_t blocks_per_probe : LocalDistances::kBlocksPerProbe) {
    for (int b = 0; b < 2; ++b) {
      distances_[b].probe(blocks_per_probe);
      deepest = std::max(deepest, unit(b) * distances_[b].deepest_probed());
    }
    for (int b = 0; b < 2; ++b) {
      distances_[b].mark_deeper(deepest / unit(b));
      if (samples == Measured::all)
        distances_[b].keep((contact_margin_ + precision_) / unit(b));
      else
        distances_[b].keep_marked();
    }
  }
  using Samples = LocalDistances::Samples;
  for (int b = 0; b < 2; ++b)
    distances_[b].measure(deepest / unit(b), samples == Measured::all ? Samples::all : Samples::marked);
}

bool PairAnswers::within(double distance) {
  if (box_distance(bodies_[0]->box(), bodies_[1]->box()) > distance) return false;
  if (distance > 0 && !separation_ && !find_closest(distance)) intersecting_ = false;
  return (separation_ && separation_->value <= distance) || colliding().value;
}

exact::MeshPair PairAnswers::meshes() const {
  return {internals(bodies_[0]->body().sites()), internals(bodies_[1]->body().sites()), to_other_[1].map};
}

// Computes separation_ if it is at most `bound`, and returns whether it is.
bool PairAnswers::find_closest(double bound) {
  const proximity::Similarity& pose = bodies_[0]->pose();
  bound /= pose.scale;
  if (closest_faces_ != kNoFaces)
    bound = std::min(bound, exact::face_distance(meshes(), closest_faces_[0], closest_faces_[1]));
  const exact::Separation c = exact::find_closest(meshes(), bound, workspace_);
  if (c.face1 == kNone) return false;
  intersecting_ = c.intersecting;
  closest_faces_ = {c.face1, c.face2};
  const double distance = pose.scale * c.distance;
  separation_ = {.value = distance,
                 .certainty = Certainty::exact,
                 .lower = distance,
                 .upper = distance,
                 .witness = std::array{pose.map(c.point1), pose.map(c.point2)}};
  return true;
}

bool PairAnswers::surfaces_intersect() {
  if (!intersecting_) intersecting_ = exact::find_intersection(meshes(), workspace_).intersecting;
  return *intersecting_;
}

std::optional<BoundedLength> PairAnswers::depth() {
  if (!bodies_[0]->body().solid() && !bodies_[1]->body().solid()) return {};
  if (!colliding().value) return BoundedLength{.certainty = Certainty::exact};
  return bounded_depth();
}

BoundedLength PairAnswers::bounded_depth() {
  measure(Measured::deepest);
  Depth deepest;
  for (int b = 0; b < 2; ++b) deepest = deeper(deepest, in_space(b, depth_at_faces(b)));
  for (int b = 0; b < 2; ++b)
    if (!distances_[b].buried().empty())
      deepest = deeper(deepest, in_space(b, depth_of_buried(b, in_frame(b, deepest))));
  return {.value = std::max(0.0, deepest.value),
          .certainty = Certainty::bounded,
          .lower = std::max(0.0, deepest.lower - precision_),
          .upper = std::max(0.0, deepest.upper + precision_),
          .witness = deepest.points};
}

// From the frame in which the samples of `body` are measured.
PairAnswers::Depth PairAnswers::in_space(int body, Depth depth) const {
  const proximity::Similarity& pose = bodies_[1 - body]->pose();
  for (double* length : {&depth.lower, &depth.value, &depth.upper}) *length *= pose.scale;
  if (depth.points)
    for (Vec3& p : *depth.points) p = pose.map(p);
  return depth;
}

// Into the frame in which the samples of `body` are measured, without the points.
PairAnswers::Depth PairAnswers::in_frame(int body, Depth depth) const {
  const double unit = 1 / bodies_[1 - body]->pose().scale;
  return {unit * depth.lower, unit * depth.value, unit * depth.upper};
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
  std::uint32_t deepest_sample = kNone;
  std::span<const std::uint32_t> buried = on.buried();
  for (std::uint32_t i = 0; i < distances.size(); ++i) {
    if (!on.marked(i)) continue;
    if (!buried.empty() && buried.front() == i) {
      buried = buried.subspan(1);
      continue;
    }
    deepest.upper = std::max(deepest.upper, double{radii[i]} - distances[i]);
    if (-distances[i] > deepest.lower) deepest.lower = deepest.value = -distances[i], deepest_sample = i;
  }
  if (deepest_sample == kNone) return deepest;
  const Vec3& p = on.points()[deepest_sample];
  Vec3 q = p;
  cpu::cpu_search(internals(bodies_[1 - body]->body().sites()), {&p, 1}, kNoLimit,
                  [&](std::size_t, const sites::ClosestPacket& closest) { q = closest.get(0, p).point; });
  deepest.points = body == 0 ? std::array{p, q} : std::array{q, p};
  return deepest;
}

// Over the other samples, as far as they may be deeper than `known`. Distances to the boundary are
// 1-Lipschitz: samples every kStrides[0] tell which others need to be measured, these which more.
PairAnswers::Depth PairAnswers::depth_of_buried(int body, Depth known) {
  constexpr std::array<std::size_t, 3> kStrides{64, 8, 1};
  const Body& solid = bodies_[1 - body]->body();
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
      const auto& [lower, upper, point, face] = *closest[i];
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
