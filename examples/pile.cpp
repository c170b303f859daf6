// Fifty jacks of seven cubes each, which are not convex, fall onto a floor and come to rest in a pile: a
// rigid-body loop on the contacts of MultiBodyQuery. Exits with 1 if they do not rest, or are inside each
// other.
#include <sdm/sdm.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <tuple>
#include <vector>

namespace {

using sdm::Vec3;

constexpr double kRadius = 0.5, kTube = 0.2;  // of a ring, and of the tube

sdm::Mesh ring() {
  constexpr std::uint32_t kAround = 14, kAcross = 7;
  sdm::Mesh mesh;
  for (std::uint32_t i = 0; i < kAround; ++i)
    for (std::uint32_t j = 0; j < kAcross; ++j) {
      const double u = 2 * std::numbers::pi * i / kAround, v = 2 * std::numbers::pi * j / kAcross;
      const double r = kRadius + kTube * std::cos(v);
      mesh.positions.push_back({r * std::cos(u), r * std::sin(u), kTube * std::sin(v)});
      const std::uint32_t next_i = (i + 1) % kAround, next_j = (j + 1) % kAcross;
      const std::uint32_t a = i * kAcross + j, b = next_i * kAcross + j, c = next_i * kAcross + next_j,
                          d = i * kAcross + next_j;
      mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
    }
  return mesh;
}

sdm::Mesh floor() {
  sdm::Mesh mesh{{}, {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4}}, {}};
  mesh.triangles.insert(mesh.triangles.end(),
                        {{2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}});
  for (int i = 0; i < 8; ++i)
    mesh.positions.push_back({i & 1 ? 9.0 : -9.0, i & 2 ? 9.0 : -9.0, i & 4 ? 0.0 : -1.0});
  return mesh;
}

// A ring of mass 1, or a body that is fixed.
struct Body {
  Vec3 centre{}, velocity{}, spin{};
  std::array<double, 4> turn{1, 0, 0, 0};  // a unit quaternion
  bool fixed = false;

  double inverse_mass() const { return fixed ? 0 : 1; }
  // The inverse of the inertia, which is about the axis of the ring another than across it.
  Vec3 turned_by(const Vec3& momentum) const {
    constexpr double kAlong = 1 / (kRadius * kRadius + 3 * kTube * kTube / 4);
    constexpr double kAcross = 1 / (kRadius * kRadius / 2 + 5 * kTube * kTube / 8);
    const auto [w, x, y, z] = turn;
    const Vec3 axis{2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)};
    return fixed ? Vec3{} : kAcross * momentum + ((kAlong - kAcross) * dot(axis, momentum)) * axis;
  }
  Vec3 velocity_at(const Vec3& arm) const { return velocity + cross(spin, arm); }
  void push(const Vec3& arm, const Vec3& impulse) {
    velocity = velocity + inverse_mass() * impulse;
    spin = spin + turned_by(cross(arm, impulse));
  }
  void move(double time) {
    centre = centre + time * velocity;
    const auto [w, x, y, z] = turn;
    const Vec3 v{x, y, z}, rate = w * spin + cross(spin, v);
    turn = {w - time / 2 * dot(spin, v), x + time / 2 * rate[0], y + time / 2 * rate[1],
            z + time / 2 * rate[2]};
    double length = 0;
    for (const double c : turn) length += c * c;
    for (double& c : turn) c /= std::sqrt(length);
  }
  sdm::Transform pose() const {
    return sdm::Transform::translation(centre) * sdm::Transform::quaternion(turn);
  }
  // At most: the inertia about the axis is the largest.
  double kinetic_energy() const {
    return 0.5 * (dot(velocity, velocity) + (kRadius * kRadius + 3 * kTube * kTube / 4) * dot(spin, spin));
  }
};

// A contact with the impulses along its normal and two directions across it.
struct Constraint {
  Body *a, *b;
  std::array<Vec3, 3> axis;
  Vec3 arm_a, arm_b;
  double allowed = 0;  // the speed at which the bodies may approach each other
  std::array<double, 3> impulse{};

  void apply(int k, double by) {
    impulse[k] += by;
    a->push(arm_a, by * axis[k]);
    b->push(arm_b, -by * axis[k]);
  }
  void solve() {
    constexpr double kFriction = 0.6;
    for (const int k : {1, 2, 0}) {
      const double speed = dot(axis[k], a->velocity_at(arm_a) - b->velocity_at(arm_b));
      const Vec3 turn_a = cross(arm_a, axis[k]), turn_b = cross(arm_b, axis[k]);
      const double inverse = a->inverse_mass() + b->inverse_mass() + dot(turn_a, a->turned_by(turn_a)) +
                             dot(turn_b, b->turned_by(turn_b));
      const double wanted = impulse[k] - (k == 0 ? speed + allowed : speed) / inverse;
      const double most = kFriction * impulse[0];
      apply(k, (k == 0 ? std::max(wanted, 0.0) : std::clamp(wanted, -most, most)) - impulse[k]);
    }
  }
};

}  // namespace

int main() {
  constexpr int kRings = 50, kFrames = 500, kIterations = 15;
  constexpr double kTime = 1.0 / 120, kGravity = 9.81, kMargin = 0.02, kSlop = 1e-3, kDamping = 0.97,
                   kPush = 0.5;
  std::vector<sdm::Shape> shapes(kRings, sdm::Shape(ring()));
  shapes.emplace_back(floor());
  std::vector<Body> bodies(shapes.size());
  for (int i = 0; i < kRings; ++i) {  // five by five, in two layers, each turned by its own angle
    bodies[i].centre = {1.5 * (i % 5 - 2), 1.5 * (i / 5 % 5 - 2), 0.8 + 1.5 * (i / 25)};
    bodies[i].turn = {std::cos(i), std::sin(i) * std::cos(3 * i), std::sin(i) * std::sin(3 * i), 0};
  }
  bodies.back().fixed = true;

  sdm::MultiBodyQuery query(shapes, {.contact_margin = kMargin});
  query.set_filter(kRings, {.fixed = true});  // the floor
  std::vector<sdm::Transform> poses(bodies.size());
  using Key = std::tuple<std::uint32_t, std::uint32_t, std::uint64_t>;  // of a contact: bodies and id
  std::map<Key, std::array<double, 3>> impulses;
  double energy = 0;
  for (int frame = 1; frame <= kFrames; ++frame) {
    for (Body& body : bodies)
      if (!body.fixed) {
        body.velocity = kDamping * body.velocity - Vec3{0, 0, kTime * kGravity};
        body.spin = kDamping * body.spin;
      }
    for (std::size_t i = 0; i < bodies.size(); ++i) poses[i] = bodies[i].pose();
    query.set_poses(poses);

    std::vector<Constraint> constraints;
    std::vector<Key> keys;
    for (const auto& [first, second, contacts, parts] : query.contacts()) {
      Body &a = bodies[first], &b = bodies[second];
      for (const sdm::Contact& c : contacts) {
        const Vec3 other = std::abs(c.normal[0]) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
        const Vec3 across = normalized(cross(c.normal, other));
        const double gap = -c.depth;  // below 0: pushed out, a fifth of it in each frame
        constraints.push_back(
            {&a,
             &b,
             {c.normal, across, cross(c.normal, across)},
             c.point1 - a.centre,
             c.point2 - b.centre,
             gap > 0 ? gap / kTime : std::max(0.2 * std::min(gap + kSlop, 0.0) / kTime, -kPush)});
        keys.emplace_back(first, second, c.id);
        const auto before = impulses.find(keys.back());
        if (before == impulses.end()) continue;
        for (int k = 0; k < 3; ++k) constraints.back().apply(k, before->second[k]);
      }
    }
    for (int i = 0; i < kIterations; ++i)
      for (Constraint& constraint : constraints) constraint.solve();
    impulses.clear();
    for (std::size_t i = 0; i < constraints.size(); ++i) impulses[keys[i]] = constraints[i].impulse;
    for (Body& body : bodies) body.move(kTime);
    // What pushed bodies out of each other is no motion that lasts.
    for (Constraint& constraint : constraints) constraint.allowed = std::max(constraint.allowed, 0.0);
    for (int i = 0; i < kIterations / 3; ++i)
      for (Constraint& constraint : constraints) constraint.solve();

    if (frame % 100 != 0) continue;
    energy = 0;
    for (const Body& body : bodies) energy += body.kinetic_energy();
    std::printf("frame %3d: %zu contacts, kinetic energy %.5f\n", frame, constraints.size(), energy);
  }

  double deepest = 0, highest = 0;
  for (const sdm::PairDepth& pair : query.penetration_depths())
    deepest = std::max(deepest, pair.penetration_depth.upper);
  for (int i = 0; i < kRings; ++i) highest = std::max(highest, bodies[i].centre[2]);
  std::printf("the highest is at %.2f; none is deeper than %.4f in another\n", highest, deepest);
  return energy < 1e-3 && deepest < kTube / 6 ? 0 : 1;
}
