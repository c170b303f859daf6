#include "proximity/pair/pair_answers.h"

#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "geometry/boxes/sweep.h"
#include "geometry/vec.h"
#include "query/pairs/collision.h"

namespace sdm::pair {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

}  // namespace

void check_options(double contact_margin, const std::optional<double>& depth_precision) {
  const auto fail = [](const char* what, double length, const char* remedy) {
    throw Error(std::string(what) + " of " + std::to_string(length) + " is out of range; use " + remedy);
  };
  if (!(contact_margin >= 0 && std::isfinite(contact_margin)))
    fail("a contact margin", contact_margin, "0 or more");
  if (depth_precision && !(*depth_precision > 0 && std::isfinite(*depth_precision)))
    fail("a precision of the depth", *depth_precision, "a length above 0");
}

void PairAnswers::begin(const shape::PosedBody& o1, const shape::PosedBody& o2, const KnownAnswers& known) {
  bodies_ = {&o1, &o2};
  known_ = known;
  contacts_.reset();
  for (int b = 0; b < 2; ++b) {
    const mesh::Similarity &from = bodies_[b]->pose(), &to = bodies_[1 - b]->pose();
    to_other_[b] = {inverse(to.map) * from.map, from.scale / to.scale};
  }
  Box box = o1.box();
  extend(box, o2.box());
  precision_ = 1e-6 * diagonal(box);
}

const BoundedLength& PairAnswers::separation() {
  if (!known_.separation) find_closest(kNoLimit);
  return *known_.separation;
}

bool PairAnswers::colliding() {
  if (!known_.colliding)
    known_.colliding = box_distance(bodies_[0]->box(), bodies_[1]->box()) == 0 &&
                       (surfaces_intersect() || pairs::one_contains_part_of_other(meshes()));
  return *known_.colliding;
}

const std::optional<BoundedLength>& PairAnswers::penetration_depth() {
  if (!known_.depth) known_.depth = depth();
  return *known_.depth;
}

std::span<const Contact> PairAnswers::contacts() {
  if (!contacts_ && !within(contact_margin_)) contacts_ = std::span<const Contact>();
  if (!contacts_) contacts_ = contact_finder_.find(bodies_, meshes(), to_other_, contact_margin_, precision_);
  return *contacts_;
}

bool PairAnswers::surfaces_within(double distance) {
  if (!known_.separation && known_.beyond < distance) {
    if (boxes_or_balls_apart(distance))
      known_.beyond = distance, known_.intersecting = known_.colliding = false;
    else if (distance > 0 && !find_closest(distance))
      known_.beyond = distance, known_.intersecting = false;
  }
  return known_.separation && known_.separation->value <= distance;
}

bool PairAnswers::within(double distance) {
  return surfaces_within(distance) || colliding();
}

bool PairAnswers::boxes_or_balls_apart(double distance) const {
  if (box_distance(bodies_[0]->box(), bodies_[1]->box()) > distance) return true;
  const shape::Ball &ball1 = bodies_[0]->ball(), &ball2 = bodies_[1]->ball();
  return norm(ball2.centre - ball1.centre) > distance + ball1.radius + ball2.radius;
}

pairs::MeshPair PairAnswers::meshes() const {
  const shape::Body &o1 = bodies_[0]->body(), &o2 = bodies_[1]->body();
  return {internals(o1.sites()), internals(o2.sites()), to_other_[1].map, {&o1.cylinders(), &o2.cylinders()}};
}

// Computes known_.separation if it is at most `bound`, and returns whether it is.
bool PairAnswers::find_closest(double bound) {
  const mesh::Similarity& pose = bodies_[0]->pose();
  const pairs::Separation c =
      pairs::find_closest(meshes(), bound / pose.scale, workspace_, known_.closest_faces);
  if (c.face1 == kNone) return false;
  known_.intersecting = c.intersecting;
  known_.closest_faces = {c.face1, c.face2};
  const double distance = pose.scale * c.distance;
  known_.separation = {
      {.value = distance, .certainty = Certainty::exact, .lower = distance, .upper = distance},
      std::array{pose.map(c.point1), pose.map(c.point2)}};
  return true;
}

bool PairAnswers::surfaces_intersect() {
  if (!known_.intersecting) known_.intersecting = pairs::find_intersection(meshes(), workspace_).intersecting;
  return *known_.intersecting;
}

std::optional<BoundedLength> PairAnswers::depth() {
  if (!bodies_[0]->body().solid() && !bodies_[1]->body().solid()) return {};
  if (!colliding()) return BoundedLength{{.certainty = Certainty::exact}};
  const double size = std::min(diagonal(bodies_[0]->box()), diagonal(bodies_[1]->box()));
  const depth::Depth found = depth_search_.find(
      bodies_, to_other_, depth_precision_.value_or(ProximityOptions::kDepthPrecision * size));
  return BoundedLength{{.value = found.value,
                        .certainty = Certainty::bounded,
                        .lower = std::max(0.0, found.lower - precision_),
                        .upper = found.upper + precision_},
                       found.points};
}

}  // namespace sdm::pair
