#include "scenes/rigid_world.h"

#include <algorithm>
#include <cmath>

namespace sdm::scenes {
namespace {

constexpr double kSettled = 1e-8;  // a change of a velocity, of a sweep over all contacts

Matrix transposed(const Matrix& m) {
  Matrix t;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) t[i][k] = m[k][i];
  return t;
}

Matrix inverse_of(const Matrix& m) {
  const double determinant = dot(m[0], cross(m[1], m[2]));
  const Matrix rows{(1 / determinant) * cross(m[1], m[2]), (1 / determinant) * cross(m[2], m[0]),
                    (1 / determinant) * cross(m[0], m[1])};
  return transposed(rows);
}

// Euler's equations over a step without a moment, I (w' − w)/h = −v × I v with v = (w + w')/2, by fixed-point
// iteration. Their product with v shows that w'·I w' = w·I w.
Vec3 turned_freely(const Matrix& inertia, const Matrix& inverse, const Vec3& w, double step) {
  Vec3 next = w;
  for (int i = 0; i < 64; ++i) {
    const Vec3 middle = 0.5 * (w + next);
    const Vec3 better = w - step * (inverse * cross(middle, inertia * middle));
    const double change = norm(better - next);
    next = better;
    if (change <= 1e-15 * norm(w)) break;
  }
  return next;
}

std::vector<Shape> shapes_of(const std::vector<RigidStart>& bodies) {
  std::vector<Shape> shapes;
  for (const RigidStart& body : bodies) shapes.push_back(body.shape);
  return shapes;
}

}  // namespace

// Sums over the tetrahedra of the triangles and the origin: with corners a, b, c and 6 V = a·(b × c),
// ∫ x dV = V (a + b + c)/4 and ∫ x xᵀ dV = V/20 (a aᵀ + b bᵀ + c cᵀ + s sᵀ), s = a + b + c.
MassProperties mass_properties(const Mesh& mesh) {
  MassProperties total;
  Matrix moments{};
  for (const Triangle& triangle : mesh.triangles) {
    const Vec3 &a = mesh.positions[triangle[0]], &b = mesh.positions[triangle[1]],
               &c = mesh.positions[triangle[2]], s = a + b + c;
    const double volume = dot(a, cross(b, c)) / 6;
    total.mass += volume;
    total.centre += 0.25 * volume * s;
    for (int k = 0; k < 3; ++k) moments[k] += volume / 20 * (a[k] * a + b[k] * b + c[k] * c + s[k] * s);
  }
  total.centre = (1 / total.mass) * total.centre;
  for (int k = 0; k < 3; ++k) moments[k] = moments[k] - total.mass * total.centre[k] * total.centre;
  const double trace = moments[0][0] + moments[1][1] + moments[2][2];
  for (int k = 0; k < 3; ++k) {
    total.inertia[k] = -moments[k];
    total.inertia[k][k] += trace;
  }
  return total;
}

RigidWorld::RigidWorld(const std::vector<RigidStart>& bodies, const RigidSettings& settings)
    : settings_(settings),
      query_(shapes_of(bodies),
             {.contact_margin = settings.margin, .ignore_internal_edges = settings.ignore_internal_edges}) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const RigidStart& start = bodies[b];
    query_.set_pose(b, start.pose);
    query_.set_filter(b, {.fixed = start.fixed});
    Body& body = bodies_.emplace_back();
    const Mesh& mesh = start.shape.sites().mesh();
    const MassProperties properties = mass_properties(mesh);
    body.centre_in_mesh = properties.centre;
    body.centre = start.pose(properties.centre);
    for (int k = 0; k < 3; ++k) {
      Vec3 axis{};
      axis[k] = 1;
      body.turn[k] = start.pose(axis) - start.pose(Vec3{});
    }
    for (const Vec3& p : mesh.positions) body.radius = std::max(body.radius, norm(p - properties.centre));
    if (start.fixed) continue;
    body.velocity = start.velocity;
    body.spin = start.spin;
    body.mass = properties.mass;
    body.inverse_mass = 1 / properties.mass;
    body.inertia = properties.inertia;
    body.inverse_inertia = inverse_of(properties.inertia);
  }
}

Transform RigidWorld::pose_of(const Body& body) {
  Transform pose;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) pose.rows[i][k] = body.turn[k][i];
    pose.rows[i][3] = body.centre[i];
  }
  return pose * Transform::translation(-body.centre_in_mesh);
}

void RigidWorld::step() {
  find_rows();
  fall();
  start_from_last();
  for (sweeps_ = 1; sweeps_ <= settings_.most_sweeps; ++sweeps_)
    if (sweep() <= kSettled) break;
  last_.clear();
  for (const Row& row : rows_)
    last_[row.key] = {row.axes[0].impulse, row.axes[1].impulse, row.axes[2].impulse};
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    Body& body = bodies_[b];
    if (body.mass == 0) continue;
    body.centre += settings_.step * body.velocity;
    if (const double speed = norm(body.spin); speed > 0)
      body.turn = rotation_about((1 / speed) * body.spin, settings_.step * speed) * body.turn;
    query_.set_pose(b, pose_of(body));
  }
}

// Without contacts.
void RigidWorld::fall() {
  for (Body& body : bodies_) {
    if (body.mass == 0) continue;
    body.velocity += settings_.step * settings_.gravity;
    const Vec3 spin = transposed(body.turn) * body.spin;
    body.spin = body.turn * turned_freely(body.inertia, body.inverse_inertia, spin, settings_.step);
  }
}

void RigidWorld::find_rows() {
  for (Body& body : bodies_)
    if (body.mass > 0) body.inverse_in_space = body.turn * body.inverse_inertia * transposed(body.turn);
  rows_.clear();
  for (const PairContacts& pair : settings_.separating ? query_.separating_contacts() : query_.contacts())
    for (const Contact& contact : pair.contacts) add_row(pair, contact);
}

void RigidWorld::add_row(const PairContacts& pair, const Contact& contact) {
  Row& row = rows_.emplace_back();
  row.bodies = {&bodies_[pair.first], &bodies_[pair.second]};
  row.key = {pair.first, pair.second, pair.parts, contact.id};
  row.allowed = std::max(0.0, -contact.depth) / settings_.step;
  const Vec3 place = 0.5 * (contact.point1 + contact.point2);
  const Vec3 other = std::abs(contact.normal[0]) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  row.axes[0].along = contact.normal;
  row.axes[1].along = normalized(cross(contact.normal, other));
  row.axes[2].along = cross(contact.normal, row.axes[1].along);
  for (Axis& axis : row.axes)
    for (int i = 0; i < 2; ++i) {
      const Body& body = *row.bodies[i];
      axis.moment[i] = cross(place - body.centre, axis.along);
      axis.turned[i] = body.inverse_in_space * axis.moment[i];
      axis.inverse += body.inverse_mass + dot(axis.moment[i], axis.turned[i]);
    }
}

double RigidWorld::speed_along(const Row& row, const Axis& axis) {
  const Body &a = *row.bodies[0], &b = *row.bodies[1];
  return dot(axis.along, a.velocity - b.velocity) + dot(axis.moment[0], a.spin) - dot(axis.moment[1], b.spin);
}

void RigidWorld::push(Row& row, Axis& axis, double impulse) {
  axis.impulse += impulse;
  for (int i = 0; i < 2; ++i) {
    Body& body = *row.bodies[i];
    const double by = i == 0 ? impulse : -impulse;
    body.velocity += by * body.inverse_mass * axis.along;
    body.spin += by * axis.turned[i];
  }
}

// The impulses of the last step; none if they add energy to the bodies.
void RigidWorld::start_from_last() {
  const double before = kinetic_energy();
  double through_gaps = 0;
  for (Row& row : rows_) {
    const auto last = last_.find(row.key);
    if (last == last_.end()) continue;
    for (int k = 0; k < 3; ++k) push(row, row.axes[k], last->second[k]);
    through_gaps += row.allowed * row.axes[0].impulse;
  }
  if (kinetic_energy() + through_gaps <= before) return;
  for (Row& row : rows_)
    for (Axis& axis : row.axes) push(row, axis, -axis.impulse);
}

// Returns the largest change of a velocity.
double RigidWorld::sweep() {
  double largest = 0;
  for (Row& row : rows_)
    for (const int k : {1, 2, 0}) {
      Axis& axis = row.axes[k];
      const double most = settings_.friction * row.axes[0].impulse;
      const double wanted =
          axis.impulse - (speed_along(row, axis) + (k == 0 ? row.allowed : 0)) / axis.inverse;
      const double by = (k == 0 ? std::max(wanted, 0.0) : std::clamp(wanted, -most, most)) - axis.impulse;
      push(row, axis, by);
      largest = std::max(largest, std::abs(by) * axis.inverse);
    }
  return largest;
}

double RigidWorld::kinetic_energy() const {
  double energy = 0;
  for (const Body& body : bodies_) {
    const Vec3 spin = transposed(body.turn) * body.spin;
    energy += 0.5 * (body.mass * dot(body.velocity, body.velocity) + dot(spin, body.inertia * spin));
  }
  return energy;
}

double RigidWorld::energy() const {
  double energy = kinetic_energy();
  for (const Body& body : bodies_) energy -= body.mass * dot(settings_.gravity, body.centre);
  return energy;
}

double RigidWorld::speed() const {
  double speed = 0;
  for (const Body& body : bodies_)
    if (body.mass > 0) speed = std::max(speed, norm(body.velocity) + body.radius * norm(body.spin));
  return speed;
}

double RigidWorld::penetration() {
  double deepest = 0;
  for (const PairDepth& pair : query_.penetration_depths())
    deepest = std::max(deepest, pair.penetration_depth.upper);
  return deepest;
}

}  // namespace sdm::scenes
