#include "scenes/cloth.h"

#include <algorithm>

#include "scenes/contacts.h"

namespace sdm::scenes {
namespace {

constexpr double kGravity = 9.81;
constexpr double kFriction = 0.3, kSolidFriction = 0.1;
/// Compliance of the springs, in metres per newton for particles of a kilogram.
constexpr double kStretch = 0, kShear = 1e-7, kBend = 5e-7;

}  // namespace

Cloth::Cloth(std::uint32_t n, double side) : thickness_(0.9 * side / (n - 1)), hash_(thickness_) {
  const auto at = [n](std::uint32_t x, std::uint32_t y) { return y * n + x; };
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x)
      mesh_.positions.push_back({side * (static_cast<double>(x) / (n - 1) - 0.5),
                                 side * (static_cast<double>(y) / (n - 1) - 0.5), 0});
  for (std::uint32_t y = 0; y + 1 < n; ++y)
    for (std::uint32_t x = 0; x + 1 < n; ++x) {
      const std::uint32_t a = at(x, y), b = at(x + 1, y), c = at(x + 1, y + 1), d = at(x, y + 1);
      if ((x + y) % 2 == 0) {  // diagonals alternate, so that folding is equally easy in both directions
        mesh_.triangles.push_back({a, b, c});
        mesh_.triangles.push_back({a, c, d});
      } else {
        mesh_.triangles.push_back({a, b, d});
        mesh_.triangles.push_back({b, c, d});
      }
    }
  // What lies between the ends: nothing, the two other corners of a square, or the particle in the middle.
  const auto across = [&](std::uint32_t x, std::uint32_t y, std::uint32_t dx,
                          std::uint32_t dy) -> std::array<std::uint32_t, 2> {
    if (dx + dy == 1 || (dx == 1 && (x + y) % 2 == 0)) return {kNone, kNone};
    if (dx == 1) return {at(x + 1, y), at(x, y + 1)};
    return {at(x + dx / 2, y + dy / 2), at(x + dx / 2, y + dy / 2)};
  };
  const auto add_springs = [&](std::uint32_t dx, std::uint32_t dy, double compliance) {
    for (std::uint32_t y = 0; y + dy < n; ++y)
      for (std::uint32_t x = 0; x + dx < n; ++x)
        add_spring(at(x, y), at(x + dx, y + dy), compliance, across(x, y, dx, dy));
  };
  add_springs(1, 0, kStretch);
  add_springs(0, 1, kStretch);
  add_springs(1, 1, kShear);
  for (std::uint32_t y = 0; y + 1 < n; ++y)
    for (std::uint32_t x = 0; x + 1 < n; ++x)
      if ((x + y) % 2 == 0)
        add_spring(at(x + 1, y), at(x, y + 1), kShear, {at(x, y), at(x + 1, y + 1)});
      else
        add_spring(at(x + 1, y), at(x, y + 1), kShear, {kNone, kNone});
  add_springs(2, 0, kBend);
  add_springs(0, 2, kBend);
  positions_ = previous_ = mesh_.positions;
  velocities_.resize(positions_.size());
  mobility_.assign(positions_.size(), 1);
}

void Cloth::add_spring(std::uint32_t a, std::uint32_t b, double compliance,
                       const std::array<std::uint32_t, 2>& across) {
  springs_.push_back({a, b, norm(mesh_.positions[b] - mesh_.positions[a]), compliance, across});
}

void Cloth::step(double dt, std::span<const Sites> solids) {
  // Limits the speed, so that no particle passes another, or through a solid, within a step.
  const double fastest = 0.25 * thickness_ / dt;
  previous_ = positions_;
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    if (mobility_[v] == 0) continue;
    velocities_[v][2] -= dt * kGravity;
    const double speed = norm(velocities_[v]);
    positions_[v] += std::min(dt, dt * fastest / std::max(speed, fastest)) * velocities_[v];
  }
  solve_springs(dt);
  resolve_self_contacts();
  for (const Sites& solid : solids) resolve_contacts(solid);
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    if (mobility_[v] == 0) positions_[v] = previous_[v];
    velocities_[v] = (1 / dt) * (positions_[v] - previous_[v]);
  }
}

// XPBD with C = |b − a| − length and inverse masses w: Δλ = −C / (w_a + w_b + compliance/dt²), Δx = ± w Δλ
// ∇C.
void Cloth::solve_springs(double dt) {
  for (const Spring& s : springs_) {
    const Vec3 along = positions_[s.b] - positions_[s.a];
    const double length = norm(along);
    const double mobility = mobility_[s.a] + mobility_[s.b];
    if (length == 0 || mobility == 0) continue;
    const Vec3 shift = ((length - s.length) / (mobility + s.compliance / (dt * dt)) / length) * along;
    positions_[s.a] += mobility_[s.a] * shift;
    positions_[s.b] += -mobility_[s.b] * shift;
  }
}

// Particles are balls whose diameter is the cloth's thickness; neighbours may be as close as at rest.
// Friction removes part of the relative motion of particles in contact.
void Cloth::resolve_self_contacts() {
  hash_.fill(positions_);
  for (std::uint32_t i = 0; i < positions_.size(); ++i)
    hash_.for_each_near(positions_[i], [&](std::uint32_t j) {
      if (j <= i) return;
      const Vec3 away = positions_[j] - positions_[i];
      const double squared = squared_norm(away);
      if (squared >= thickness_ * thickness_ || squared == 0) return;
      const double distance = std::sqrt(squared);
      const double minimum = std::min(thickness_, norm(mesh_.positions[j] - mesh_.positions[i]));
      if (distance >= minimum) return;
      const Vec3 slip = (positions_[j] - previous_[j]) - (positions_[i] - previous_[i]);
      const Vec3 shift = (0.5 * (minimum - distance) / distance) * away - (0.5 * kFriction) * slip;
      positions_[i] += -shift;
      positions_[j] += shift;
    });
}

void Cloth::resolve_contacts(const Sites& solid) {
  for (const VertexContact& c : find_contacts(positions_, solid, thickness_)) {
    Vec3 slip = positions_[c.point] - previous_[c.point];
    slip = slip - dot(slip, c.normal) * c.normal;
    const double friction = std::min(1.0, kSolidFriction * c.depth / std::max(norm(slip), 1e-30));
    positions_[c.point] += c.depth * c.normal - friction * slip;
  }
}

}  // namespace sdm::scenes
