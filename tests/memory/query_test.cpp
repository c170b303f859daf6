// Proximity queries, when memory runs out while bodies move or while answers are computed.
#include <gtest/gtest.h>
#include <sdm/multi_body_query.h>
#include <sdm/proximity_query.h>
#include <sdm/self_proximity_query.h>

#include "memory/all_or_nothing.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

Numbers numbers_of_length(const std::optional<BoundedLength>& length) {
  Numbers numbers;
  numbers.add(length.has_value());
  if (length) numbers.add(length->value, length->lower, length->upper, length->witness);
  return numbers;
}
void add_contact(Numbers& numbers, const Contact& c) {
  numbers.add(c.point1, c.point2, c.normal, c.depth, c.patch, c.on[0].face, c.on[1].face, c.on[0].barycentric,
              c.on[1].barycentric, c.id);
}

std::vector<Vec3> slightly_bent(const Mesh& mesh) {
  std::vector<Vec3> positions = mesh.positions;
  for (Vec3& p : positions) p = {p[0] + 0.1 * p[1] * p[1], 0.9 * p[1], p[2] + 0.1 * p[0]};
  return positions;
}

// Solids, one of which intersects itself, that intersect each other.
Mesh first_mesh() {
  return joined(cube(0.5), moved(sphere(0), {0.4, 0.3, 0.2}));
}
Mesh second_mesh() {
  return moved(sphere(0), {1.1, 0.8, 0.3});
}

std::unique_ptr<ProximityQuery> pair_of_bodies() {
  const AtlasOptions atlas{.resolution = 32};
  return std::make_unique<ProximityQuery>(Shape(first_mesh(), atlas), Shape(second_mesh()),
                                          ProximityOptions{.contact_margin = 0.1});
}
std::unique_ptr<ProximityQuery> pair_with_answers() {
  auto query = pair_of_bodies();
  (void)query->penetration_depth();
  (void)query->contacts();
  return query;
}

const Calls<ProximityQuery> kPair{
    [](ProximityQuery& q) { return numbers_of_length(q.separation()); },
    [](ProximityQuery& q) { return numbers_of(q.colliding()); },
    [](ProximityQuery& q) { return numbers_of_length(q.penetration_depth()); },
    [](ProximityQuery& q) {
      Numbers numbers;
      for (const Contact& contact : q.contacts()) add_contact(numbers, contact);
      return numbers;
    },
    [](ProximityQuery& q) { return numbers_of(q.surface(0).mesh(), q.surface(0).texel_faces()); },
    [](ProximityQuery& q) { return numbers_of(q.sites(0).mesh(), q.sites(0).edges()); },
    [](ProximityQuery& q) { return numbers_of(q.sites(1).mesh()); },
    [](ProximityQuery& q) {
      return numbers_of(q.pose(0).determinant(), q.pose(1)({1, 2, 3}));
    }};

TEST(FailedAllocations, LeaveAPairAsItWasOrBrokenByARefit) {
  const std::vector<Vec3> a = slightly_bent(first_mesh()), b = slightly_bent(second_mesh());
  const std::function<void(ProximityQuery&)> refit = [&](ProximityQuery& q) { q.refit(a, b); };
  for (const auto& make : {pair_of_bodies, pair_with_answers})
    (void)expect_all_or_nothing(make, refit, kPair, Guarantee::unchanged_or_broken);
}

// The first body has an atlas, the second one has none.
TEST(FailedAllocations, LeaveAPairAsItWasOrBrokenByAnEdit) {
  for (const int body : {0, 1}) {
    const auto added =
        static_cast<std::uint32_t>((body == 0 ? first_mesh() : second_mesh()).positions.size());
    const MeshEdit change{
        .removed_faces = {1}, .added_vertices = {{0.9, 0.9, 0.9}}, .added_faces = {{0, 1, added}}};
    const std::function<void(ProximityQuery&)> edit = [&](ProximityQuery& q) { q.edit(body, change); };
    (void)expect_all_or_nothing(body == 0 ? pair_with_answers : pair_of_bodies, edit, kPair,
                                Guarantee::unchanged_or_broken);
  }
}

TEST(FailedAllocations, WrongPositionsAndPosesChangeNothing) {
  const auto query = pair_with_answers();
  const auto before = observe(*query, kPair);
  std::vector<Vec3> bad = second_mesh().positions;
  bad.back()[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(query->refit(slightly_bent(first_mesh()), bad), Error);
  EXPECT_THROW(query->set_pose(1, {.rows = {{{1, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}}}),
               Error);
  EXPECT_THROW(query->edit(0, {.removed_faces = {1, 1}}), Error);
  EXPECT_THROW(query->edit(1, {.removed_faces = {1, 1}}), Error);
  EXPECT_TRUE(observe(*query, kPair) == before);
}

// Once, a depth without memory was reported as that of bodies without an inside from then on.
TEST(FailedAllocations, AnswersAreGivenByTheNextCall) {
  for (const auto& call : kPair) expect_repeatable(pair_of_bodies, call);
}

std::unique_ptr<ProximityQuery> convex_bodies() {
  auto query = std::make_unique<ProximityQuery>(Shape(cube(0.5)), Shape(sphere(1)));
  query->set_pose(1, Transform::translation({0.9, 0.7, 0.3}));
  return query;
}

// What a search that ended half-way leaves in memory that is reused.
TEST(FailedAllocations, ContactsOfConvexSolidsAreGivenByTheNextCall) {
  const std::function<Numbers(ProximityQuery&)> call = [](ProximityQuery& q) {
    Numbers numbers;
    for (const Contact& contact : q.separating_contacts(2)) add_contact(numbers, contact);
    return numbers;
  };
  expect_repeatable(convex_bodies, call);
}

std::unique_ptr<MultiBodyQuery> bodies() {
  const AtlasOptions atlas{.resolution = 16};
  std::vector<Shape> shapes{Shape(first_mesh(), atlas), Shape(second_mesh()),
                            Shape(moved(cube(0.3), {3, 0, 0}))};
  return std::make_unique<MultiBodyQuery>(std::move(shapes), ProximityOptions{.contact_margin = 0.1});
}
std::unique_ptr<MultiBodyQuery> bodies_with_answers() {
  auto query = bodies();
  (void)query->separations(4);
  (void)query->penetration_depths();
  (void)query->contacts();
  (void)query->separating_contacts();
  return query;
}

const Calls<MultiBodyQuery> kBodies{
    [](MultiBodyQuery& q) { return numbers_of(q.size()); },
    [](MultiBodyQuery& q) {
      Numbers numbers;
      for (const PairSeparation& pair : q.separations(4))
        numbers.add(pair.first, pair.second, pair.colliding, pair.separation.value);
      numbers.add(q.candidate_pairs());
      return numbers;
    },
    [](MultiBodyQuery& q) {
      Numbers numbers;
      for (const PairDepth& pair : q.penetration_depths())
        numbers.add(pair.first, pair.second, pair.penetration_depth.lower, pair.penetration_depth.upper);
      return numbers;
    },
    [](MultiBodyQuery& q) {
      Numbers numbers;
      for (const BodyPair& pair : q.colliding()) numbers.add(pair.first, pair.second);
      return numbers;
    },
    [](MultiBodyQuery& q) {
      Numbers numbers;
      for (const PairContacts& pair : q.contacts()) {
        numbers.add(pair.first, pair.second);
        for (const Contact& contact : pair.contacts) add_contact(numbers, contact);
      }
      return numbers;
    },
    [](MultiBodyQuery& q) {
      Numbers numbers;
      for (const PairTranslation& pair : q.separating_translations())
        numbers.add(pair.first, pair.second, pair.separating_translation.lower,
                    pair.separating_translation.translation);
      return numbers;
    },
    [](MultiBodyQuery& q) {
      Numbers numbers;
      for (const PairContacts& pair : q.separating_contacts(2)) {
        numbers.add(pair.first, pair.second);
        for (const Contact& contact : pair.contacts) add_contact(numbers, contact);
      }
      return numbers;
    },
    [](MultiBodyQuery& q) {
      const NearestMap nearest = q.nearest_map(0, 4);
      return numbers_of(nearest.body, nearest.map.distance);
    },
    [](MultiBodyQuery& q) { return numbers_of(nearest_distances_at_vertices(q, 1, 9)); },
    [](MultiBodyQuery& q) {
      return numbers_of(q.surface(0).mesh(), q.pose(0)({1, 2, 3}));
    },
    [](MultiBodyQuery& q) {
      return numbers_of(q.sites(1).mesh(), q.pose(1)({1, 2, 3}));
    },
    [](MultiBodyQuery& q) {
      return numbers_of(q.sites(2).mesh(), q.pose(2)({1, 2, 3}));
    }};

TEST(FailedAllocations, LeaveManyBodiesAsTheyWereOrBrokenByARefit) {
  const std::vector<Vec3> a = slightly_bent(first_mesh()), b = slightly_bent(second_mesh());
  const std::function<void(MultiBodyQuery&)> one = [&](MultiBodyQuery& q) { q.refit(0, a); };
  const std::function<void(MultiBodyQuery&)> all = [&](MultiBodyQuery& q) {
    q.refit(std::array<std::span<const Vec3>, 3>{a, b, std::span<const Vec3>{}});
  };
  for (const auto& make : {bodies, bodies_with_answers})
    for (const auto& change : {one, all})
      (void)expect_all_or_nothing(make, change, kBodies, Guarantee::unchanged_or_broken);
}

TEST(FailedAllocations, WrongPositionsAndPosesOfOneBodyMoveNone) {
  const auto query = bodies_with_answers();
  const auto before = observe(*query, kBodies);
  const std::vector<Vec3> good = slightly_bent(first_mesh());
  std::vector<Vec3> bad = second_mesh().positions;
  bad.pop_back();
  EXPECT_THROW(query->refit(std::array<std::span<const Vec3>, 3>{good, bad, std::span<const Vec3>{}}), Error);
  std::array<Transform, 3> poses;
  poses[0] = Transform::translation({1, 0, 0});
  poses[2].rows[0][0] = 3;
  EXPECT_THROW(query->set_poses(poses), Error);
  EXPECT_TRUE(observe(*query, kBodies) == before);
}

TEST(FailedAllocations, AnswersOfManyBodiesAreGivenByTheNextCall) {
  for (const auto& call : kBodies) expect_repeatable(bodies, call);
}

std::unique_ptr<SelfProximityQuery> folded(const ExclusionRule& rule) {
  return std::make_unique<SelfProximityQuery>(joined(square(1, 0.1), joined(sphere(0), cube(0.3))),
                                              SelfProximityOptions{.exclusion = rule});
}

const Calls<SelfProximityQuery> kSelf{
    [](SelfProximityQuery& q) { return numbers_of_length(q.separation()); },
    [](SelfProximityQuery& q) {
      Numbers numbers;
      for (const Contact& contact : q.contacts(0.8)) add_contact(numbers, contact);
      return numbers;
    },
    [](SelfProximityQuery& q) { return numbers_of(q.sites().mesh()); },
    [](SelfProximityQuery& q) { return numbers_of(q.exclusion().patches()); }};

TEST(FailedAllocations, LeaveAFoldedSurfaceAsItWasOrBrokenByARefit) {
  const std::vector<Vec3> positions = slightly_bent(folded({})->sites().mesh());
  const std::function<void(SelfProximityQuery&)> refit = [&](SelfProximityQuery& q) { q.refit(positions); };
  for (const bool answered : {false, true}) {
    const auto make = [&] {
      auto query = folded({});
      if (answered) (void)query->separation();
      return query;
    };
    (void)expect_all_or_nothing(make, refit, kSelf, Guarantee::unchanged_or_broken);
  }
}

TEST(FailedAllocations, AnswersOfAFoldedSurfaceAreGivenByTheNextCall) {
  for (const auto& call : kSelf) expect_repeatable([] { return folded({}); }, call);
}

// What a thread marks while it looks for the neighbours of a face is unmarked.
TEST(FailedAllocations, LeaveNoMarksForTheNextExclusion) {
  for (const ExclusionRule& rule : {ExclusionRule{.rings = 2}, ExclusionRule{.geodesic = 0.7}}) {
    const std::function<Numbers(Mesh&)> exclude = [&](Mesh& mesh) {
      const Exclusion exclusion(mesh, {.rule = rule});
      Numbers numbers;
      for (std::uint32_t p = 0; p < exclusion.patches(); ++p)
        numbers.add(exclusion.faces_of(p), exclusion.excluded_by(p));
      return numbers;
    };
    expect_repeatable([] { return std::make_unique<Mesh>(ring(5)); }, exclude);
  }
}

}  // namespace
}  // namespace sdm::test
