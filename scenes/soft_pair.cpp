#include "scenes/soft_pair.h"

#include "scenes/contacts.h"

namespace sdm::scenes {

SoftPair::SoftPair(std::array<SoftBody, 2> bodies, const std::vector<Scene::Body>& shapes, double gap)
    : bodies_(std::move(bodies)), sites_{Sites(shapes[0].mesh), Sites(shapes[1].mesh)}, gap_(gap) {}

void SoftPair::advance(std::vector<Scene::Body>& bodies) {
  constexpr int kSteps = 8;
  for (int i = 0; i < kSteps; ++i) step(kTimeStep / kSteps);
  for (std::size_t i = 0; i < 2; ++i)
    bodies[i].mesh.positions.assign(bodies_[i].positions().begin(), bodies_[i].positions().end());
}

void SoftPair::step(double dt) {
  for (SoftBody& body : bodies_) body.begin_step(dt);
  push_apart(0, 1, dt);
  push_apart(1, 0, dt);
  for (SoftBody& body : bodies_) {
    body.match_shapes();
    body.end_step(dt);
  }
}

// A vertex p and the closest point q = Σ w x on a face of the other body are moved apart until (p − q)·normal
// is the gap: p by 1 and the corners by w, times depth / (1 + Σ w²), which conserves momentum. Their relative
// tangential displacement is reduced by at most kFriction · depth (Coulomb friction).
void SoftPair::push_apart(std::size_t points, std::size_t solid, double dt) {
  constexpr double kFriction = 0.2, kFastest = 3;  // m/s: limits the energy that deep contacts add
  SoftBody &one = bodies_[points], &other = bodies_[solid];
  sites_[solid].refit(other.positions());
  for (const VertexContact& c : find_contacts(one.positions(), sites_[solid], gap_)) {
    Vec3 point = one.positions()[c.point], slip = one.displacement(c.point);
    double mass = 1;
    for (int k = 0; k < 3; ++k) {
      point = point - c.weights[k] * other.positions()[c.face[k]];
      slip = slip - c.weights[k] * other.displacement(c.face[k]);
      mass += c.weights[k] * c.weights[k];
    }
    const double depth = std::min(gap_ - dot(point, c.normal),
                                  kFastest * dt);  // earlier contacts may have moved the corners
    if (depth <= 0) continue;
    slip = slip - dot(slip, c.normal) * c.normal;
    const double friction = std::min(1.0, kFriction * depth / std::max(norm(slip), 1e-30));
    const Vec3 push = (1 / mass) * (depth * c.normal - friction * slip);
    one.move(c.point, push);
    for (int k = 0; k < 3; ++k) other.move(c.face[k], -c.weights[k] * push);
  }
}

}  // namespace sdm::scenes
