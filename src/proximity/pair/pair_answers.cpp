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

void PairAnswers::begin(const shape::PosedBody& o1, const shape::PosedBody& o2, const FacePair& hint) {
  bodies_ = {&o1, &o2};
  results_ = {.closest_faces = hint};
  for (int b = 0; b < 2; ++b) {
    const mesh::Similarity &from = bodies_[b]->pose(), &to = bodies_[1 - b]->pose();
    to_other_[b] = {inverse(to.map) * from.map, from.scale / to.scale};
  }
  Box box = o1.box();
  extend(box, o2.box());
  precision_ = 1e-6 * diagonal(box);
}

const BoundedLength& PairAnswers::separation() {
  if (!results_.separation) find_closest(kNoLimit);
  return *results_.separation;
}

bool PairAnswers::colliding() {
  if (!results_.colliding)
    results_.colliding = box_distance(bodies_[0]->box(), bodies_[1]->box()) == 0 &&
                         (surfaces_intersect() || pairs::one_contains_part_of_other(meshes()));
  return *results_.colliding;
}

const std::optional<BoundedLength>& PairAnswers::penetration_depth() {
  if (!results_.depth) results_.depth = depth();
  return *results_.depth;
}

std::span<const Contact> PairAnswers::contacts() {
  if (!results_.contacts && !within(contact_margin_)) results_.contacts = std::span<const Contact>();
  if (!results_.contacts)
    results_.contacts = contact_finder_.find(bodies_, meshes(), to_other_, contact_margin_, precision_);
  return *results_.contacts;
}

bool PairAnswers::within(double distance) {
  if (box_distance(bodies_[0]->box(), bodies_[1]->box()) > distance) return false;
  const shape::Ball &ball1 = bodies_[0]->ball(), &ball2 = bodies_[1]->ball();
  if (norm(ball2.centre - ball1.centre) > distance + ball1.radius + ball2.radius) return false;
  if (distance > 0 && !results_.separation && !find_closest(distance)) results_.intersecting = false;
  return (results_.separation && results_.separation->value <= distance) || colliding();
}

pairs::MeshPair PairAnswers::meshes() const {
  const shape::Body &o1 = bodies_[0]->body(), &o2 = bodies_[1]->body();
  return {internals(o1.sites()), internals(o2.sites()), to_other_[1].map, {&o1.cylinders(), &o2.cylinders()}};
}

// Computes results_.separation if it is at most `bound`, and returns whether it is.
bool PairAnswers::find_closest(double bound) {
  const mesh::Similarity& pose = bodies_[0]->pose();
  const pairs::Separation c =
      pairs::find_closest(meshes(), bound / pose.scale, workspace_, results_.closest_faces);
  if (c.face1 == kNone) return false;
  results_.intersecting = c.intersecting;
  results_.closest_faces = {c.face1, c.face2};
  const double distance = pose.scale * c.distance;
  results_.separation = {
      {.value = distance, .certainty = Certainty::exact, .lower = distance, .upper = distance},
      std::array{pose.map(c.point1), pose.map(c.point2)}};
  return true;
}

bool PairAnswers::surfaces_intersect() {
  if (!results_.intersecting)
    results_.intersecting = pairs::find_intersection(meshes(), workspace_).intersecting;
  return *results_.intersecting;
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
