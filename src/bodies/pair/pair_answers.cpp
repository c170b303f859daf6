#include "bodies/pair/pair_answers.h"

#include <algorithm>

#include "bodies/pairs/collision.h"
#include "core/nothing_found.h"
#include "geometry/boxes.h"
#include "geometry/vec.h"

namespace sdm::pair {
namespace {

mesh::Similarity between(const mesh::Similarity& from, const mesh::Similarity& to) {
  if (to.map == Affine{}) return from;
  if (from.map == Affine{}) return {inverse(to.map), 1 / to.scale};
  return {inverse(to.map) * from.map, from.scale / to.scale};
}

}  // namespace

void PairAnswers::begin(const shape::PosedBody& o1, const shape::PosedBody& o2, const KnownAnswers& known) {
  known_ = known;
  set_bodies(o1, o2);
}
void PairAnswers::begin(const shape::PosedBody& o1, const shape::PosedBody& o2, const Hints& hints) {
  known_.forget(hints);
  set_bodies(o1, o2);
}

void PairAnswers::set_bodies(const shape::PosedBody& o1, const shape::PosedBody& o2) {
  bodies_ = {&o1, &o2};
  contacts_.reset();
  solid_.reset();
  solid_pair_ = solids::are_solid_pair(o1, o2);
  to_other_[1] = between(o2.pose(), o1.pose());
  first_to_other_known_ = false;
}

double PairAnswers::precision() const {
  return 1e-6 * size();
}

const std::array<mesh::Similarity, 2>& PairAnswers::to_other() {
  if (!first_to_other_known_) to_other_[0] = between(bodies_[0]->pose(), bodies_[1]->pose());
  first_to_other_known_ = true;
  return to_other_;
}

const BoundedLength& PairAnswers::separation() {
  if (!known_.separation) find_closest(kInfinity);
  return *known_.separation;
}

bool PairAnswers::colliding() {
  if (!known_.colliding)
    known_.colliding = box_distance(bodies_[0]->box(), bodies_[1]->box()) == 0 && find_collision();
  return *known_.colliding;
}

solids::SolidPair& PairAnswers::solid() {
  if (!solid_) solid_.emplace(*bodies_[0], *bodies_[1], solid_workspace_);
  return *solid_;
}

bool PairAnswers::find_collision() {
  if (solid_pair_) return solid().colliding();
  const pairs::MeshPair pair = meshes();
  if (!known_.intersecting)
    if (std::optional<convex::ConvexPair> convex = convex_pair(pair))
      if (const std::optional<bool> colliding = convex->colliding(known_.closest_vertices)) return *colliding;
  return surfaces_intersect() || pairs::one_contains_part_of_other(pair);
}

const std::optional<BoundedLength>& PairAnswers::penetration_depth() {
  if (!known_.depth) known_.depth = depth();
  return *known_.depth;
}

std::span<const Contact> PairAnswers::contacts() {
  if (!contacts_) contacts_ = contacts_within(contact_margin_);
  return *contacts_;
}

std::span<const Contact> PairAnswers::contacts_within(double margin) {
  contacts_.reset();
  if (!within(margin)) return {};
  if (solid_pair_) return solid_contacts_.find(*bodies_[0], *bodies_[1], solid(), margin);
  return contact_finder_.find(bodies_, meshes(), to_other(), margin, precision());
}

bool PairAnswers::surfaces_within(double distance) {
  if (!known_.separation && known_.beyond < distance) {
    if (boxes_or_balls_apart(distance)) {
      known_.beyond = distance;
      known_.intersecting = known_.colliding = false;
    } else if (distance > 0 && !find_closest(distance)) {
      known_.beyond = distance;
      known_.intersecting = false;
    }
  }
  return known_.separation && known_.separation->value <= distance;
}

bool PairAnswers::within(double distance) {
  // Of solids that collide, the distance of the surfaces takes longer.
  if (solid_pair_ && colliding()) return true;
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

std::optional<convex::ConvexPair> PairAnswers::convex_pair(const pairs::MeshPair& meshes) const {
  const convex::ConvexMesh *o1 = bodies_[0]->body().convex(), *o2 = bodies_[1]->body().convex();
  if (o1 == nullptr || o2 == nullptr) return {};
  return convex::ConvexPair(*o1, *o2, meshes, to_other_[1].scale);
}

// Computes known_.separation if it is at most `bound`, and returns whether it is.
bool PairAnswers::find_closest(double bound) {
  if (solid_pair_) return take_separation(bound);
  const mesh::Similarity& pose = bodies_[0]->pose();
  const pairs::MeshPair pair = meshes();
  const double own_bound = bound / pose.scale;
  std::optional<pairs::Separation> found;
  if (std::optional<convex::ConvexPair> convex = convex_pair(pair)) {
    found = convex->find_closest(own_bound, known_.closest_vertices, known_.closest_faces);
    // Solids that overlap intersect, or one is inside the other. The faces that are found to intersect are
    // the first ones in the order of the trees, in either search.
    if (convex->found_overlap())
      if (const pairs::Separation first = pairs::find_intersection(pair, workspace_); first.intersecting)
        found = first;
  }
  const pairs::Separation c =
      found ? *found : pairs::find_closest(pair, own_bound, workspace_, known_.closest_faces);
  if (c.face1 == kNone) {
    if (bound == kInfinity) throw_nothing_found();
    return false;
  }
  known_.intersecting = c.intersecting;
  known_.closest_faces = {c.face1, c.face2};
  const double distance = pose.scale * c.distance;
  known_.separation = {
      {.value = distance, .certainty = Certainty::exact, .lower = distance, .upper = distance},
      std::array{pose.map(c.point1), pose.map(c.point2)}};
  return true;
}

// Takes the separation of a solid pair, if it is at most `bound`.
bool PairAnswers::take_separation(double bound) {
  const solids::SurfaceDistance& found = solid().surfaces();
  if (!(found.lower <= bound)) return false;
  known_.intersecting = found.upper == 0;
  BoundedLength separation;
  separation.value = separation.upper = found.upper;
  separation.lower = found.lower;
  const bool exact = separation.upper - separation.lower <= precision();
  separation.certainty = exact ? Certainty::exact : Certainty::bounded;
  separation.witness = found.closest;
  known_.separation = separation;
  return true;
}

double PairAnswers::size() const {
  for (const int body : {0, 1})
    if (bodies_[body]->body().half_space()) return diagonal(bodies_[1 - body]->box());
  Box box = bodies_[0]->box();
  extend(box, bodies_[1]->box());
  return diagonal(box);
}

bool PairAnswers::surfaces_intersect() {
  if (!known_.intersecting) {
    // Faces that intersected in a similar pose mostly still do.
    const FacePair faces = pairs::find_common_faces(meshes(), workspace_, known_.common_faces);
    known_.intersecting = faces != kNoFaces;
    if (*known_.intersecting) known_.common_faces = faces;
  }
  return *known_.intersecting;
}

std::optional<BoundedLength> PairAnswers::depth() {
  if (!bodies_[0]->body().solid() && !bodies_[1]->body().solid()) return {};
  if (!colliding()) return BoundedLength{{.certainty = Certainty::exact}};
  if (solid_pair_) return solid().depth();
  // The diagonals of the bodies' own boxes: a box in space around a turned body is larger.
  const auto size = [&](int body) {
    return bodies_[body]->pose().scale * diagonal(bodies_[body]->body().box());
  };
  const double asked =
      depth_precision_.value_or(ProximityOptions::kDepthPrecision * std::min(size(0), size(1)));
  const depth::Depth found =
      depth_search_.find(bodies_, to_other(), std::max(asked - 2 * precision(), 0.5 * asked));
  return BoundedLength{{.value = found.value,
                        .certainty = Certainty::bounded,
                        .lower = std::max(0.0, found.lower - precision()),
                        .upper = found.upper + precision()},
                       found.points};
}

}  // namespace sdm::pair
