// Twenty blocks fall onto each other and come to rest: a rigid-body loop on the contacts of MultiBodyQuery.
#include <sdm/sdm.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <tuple>
#include <vector>

using sdm::Vec3;

namespace {

sdm::Mesh box(double x, double y, double z) {
  sdm::Mesh mesh{{},
                 {{0, 2, 3},
                  {0, 3, 1},
                  {4, 5, 7},
                  {4, 7, 6},
                  {0, 1, 5},
                  {0, 5, 4},
                  {2, 6, 7},
                  {2, 7, 3},
                  {0, 4, 6},
                  {0, 6, 2},
                  {1, 3, 7},
                  {1, 7, 5}},
                 {}};
  for (int i = 0; i < 8; ++i)
    mesh.positions.push_back({(i & 1 ? x : -x) / 2, (i & 2 ? y : -y) / 2, (i & 4 ? z : -z) / 2});
  return mesh;
}

// Of mass 1, or fixed.
struct Body {
  Vec3 centre{}, velocity{}, spin{};
  std::array<double, 4> turn{1, 0, 0, 0};        // a unit quaternion
  double inverse_mass = 1, inverse_inertia = 6;  // of a unit cube, the same about all axes

  Vec3 velocity_at(const Vec3& arm) const { return velocity + cross(spin, arm); }
  void push(const Vec3& arm, const Vec3& impulse) {
    velocity = velocity + inverse_mass * impulse;
    spin = spin + inverse_inertia * cross(arm, impulse);
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
      const double inverse = a->inverse_mass + b->inverse_mass + a->inverse_inertia * dot(turn_a, turn_a) +
                             b->inverse_inertia * dot(turn_b, turn_b);
      const double wanted = impulse[k] - (k == 0 ? speed + allowed : speed) / inverse;
      const double most = kFriction * impulse[0];
      apply(k, (k == 0 ? std::max(wanted, 0.0) : std::clamp(wanted, -most, most)) - impulse[k]);
    }
  }
};

}  // namespace

int main() {
  constexpr int kBlocks = 20, kFrames = 600, kIterations = 60;
  constexpr double kTime = 1.0 / 120, kGravity = 9.81, kMargin = 0.02, kSlop = 1e-3, kDamping = 0.97;
  const sdm::Shape block(box(1, 1, 1)), floor(box(20, 20, 1));
  std::vector<sdm::Shape> shapes(kBlocks, block);
  shapes.push_back(floor);
  std::vector<Body> bodies(shapes.size());
  for (int i = 0; i < kBlocks; ++i) {
    bodies[i].centre = {0.05 * std::sin(i), 0.05 * std::cos(2 * i), 0.51 + 1.01 * i};
    bodies[i].turn = {std::cos(0.1 * i), 0, 0, std::sin(0.1 * i)};
  }
  bodies.back() = {.centre = {0, 0, -0.5}, .inverse_mass = 0, .inverse_inertia = 0};

  sdm::MultiBodyQuery query(shapes, {.contact_margin = kMargin});
  query.set_filter(kBlocks, {.fixed = true});  // the floor
  std::vector<sdm::Transform> poses(bodies.size());
  using Key = std::tuple<std::uint32_t, std::uint32_t, std::uint64_t>;  // of a contact: bodies and id
  std::map<Key, std::array<double, 3>> impulses;
  for (int frame = 1; frame <= kFrames; ++frame) {
    for (Body& body : bodies)
      if (body.inverse_mass > 0) {
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
        Vec3 across = cross(c.normal, other);
        across = normalized(across);
        const double gap = -c.depth;  // below 0: pushed out, a fifth of it in each frame
        constraints.push_back({&a,
                               &b,
                               {c.normal, across, cross(c.normal, across)},
                               c.point1 - a.centre,
                               c.point2 - b.centre,
                               gap > 0 ? gap / kTime : 0.2 * std::min(gap + kSlop, 0.0) / kTime});
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

    if (frame % 100 != 0) continue;
    double speed = 0;
    for (const Body& body : bodies) speed = std::max(speed, std::sqrt(dot(body.velocity, body.velocity)));
    std::printf("frame %3d: top at %.3f, %zu contacts, fastest block %.5f\n", frame,
                bodies[kBlocks - 1].centre[2] + 0.5, constraints.size(), speed);
  }
}
