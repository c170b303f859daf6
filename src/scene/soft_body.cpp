#include "scene/soft_body.h"

#include <algorithm>
#include <limits>

namespace sdm {
namespace {

std::vector<std::vector<std::uint32_t>> neighbours_of(const Mesh& mesh) {
  std::vector<std::vector<std::uint32_t>> neighbours(mesh.positions.size());
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      neighbours[t[k]].push_back(t[(k + 1) % 3]);
      neighbours[t[k]].push_back(t[(k + 2) % 3]);
    }
  return neighbours;
}

}  // namespace

SoftBody::SoftBody(const Mesh& mesh, const Material& material, const Vec3& velocity,
                   const Vec3& angular_velocity)
    : stiffness_(material.stiffness), positions_(mesh.positions), previous_(mesh.positions) {
  const std::size_t n = positions_.size();
  Vec3 centre{};
  for (const Vec3& p : positions_) centre += (1.0 / static_cast<double>(n)) * p;
  for (const Vec3& p : positions_) velocities_.push_back(velocity + cross(angular_velocity, p - centre));
  pulls_.resize(n);

  // Each seed is far from those before; once there are enough, vertices that no cluster has reached are next.
  const auto neighbours = neighbours_of(mesh);
  shares_.assign(n, 0);  // as yet, the number of clusters
  std::vector<double> to_seed(n, std::numeric_limits<double>::infinity());
  std::size_t seed = 0;
  while (seed < n) {
    add_cluster(neighbours, static_cast<std::uint32_t>(seed), material.cluster_radius);
    for (std::size_t v = 0; v < n; ++v)
      to_seed[v] = std::min(to_seed[v], norm(positions_[v] - positions_[seed]));
    const auto farthest = std::ranges::max_element(to_seed) - to_seed.begin(),
               unreached = std::ranges::find(shares_, 0.0) - shares_.begin();
    seed = static_cast<std::size_t>(clusters_.size() < material.clusters ? farthest : unreached);
  }
  for (double& share : shares_) share = 1 / share;

  for (Cluster& cluster : clusters_) {
    Vec3 sum{};
    double mass = 0;
    for (const std::uint32_t v : cluster.vertices) sum += shares_[v] * positions_[v], mass += shares_[v];
    for (const std::uint32_t v : cluster.vertices) cluster.rest.push_back(positions_[v] - (1 / mass) * sum);
  }
}

// The vertices within the radius that a path of such vertices leads to: not the other arm of an E.
void SoftBody::add_cluster(const std::vector<std::vector<std::uint32_t>>& neighbours, std::uint32_t seed,
                           double radius) {
  std::vector<std::uint32_t>& vertices = clusters_.emplace_back().vertices;
  std::vector<bool> met(positions_.size(), false);
  vertices.push_back(seed);
  met[seed] = true;
  for (std::size_t i = 0; i < vertices.size(); ++i)
    for (const std::uint32_t w : neighbours[vertices[i]]) {
      if (met[w] || norm(positions_[w] - positions_[seed]) > radius) continue;
      met[w] = true;
      vertices.push_back(w);
    }
  for (const std::uint32_t v : vertices) ++shares_[v];
}

void SoftBody::begin_step(double dt) {
  previous_ = positions_;
  for (std::size_t v = 0; v < positions_.size(); ++v) positions_[v] += dt * velocities_[v];
}

void SoftBody::seek_shape() {
  std::ranges::fill(pulls_, Vec3{});
  for (Cluster& cluster : clusters_) {
    Vec3 centre{};
    double mass = 0;
    for (const std::uint32_t v : cluster.vertices) centre += shares_[v] * positions_[v], mass += shares_[v];
    centre = (1 / mass) * centre;
    Matrix moment{};  // Σ m (x − centre) restᵀ
    for (std::size_t i = 0; i < cluster.vertices.size(); ++i) {
      const std::uint32_t v = cluster.vertices[i];
      for (int k = 0; k < 3; ++k) moment[k] += (shares_[v] * cluster.rest[i][k]) * (positions_[v] - centre);
    }
    cluster.rotation = rotation_part(moment, cluster.rotation);
    for (std::size_t i = 0; i < cluster.vertices.size(); ++i) {
      const std::uint32_t v = cluster.vertices[i];
      pulls_[v] += shares_[v] * (centre + cluster.rotation * cluster.rest[i] - positions_[v]);
    }
  }
  for (std::size_t v = 0; v < positions_.size(); ++v) positions_[v] += stiffness_ * pulls_[v];
}

void SoftBody::end_step(double dt) {
  for (std::size_t v = 0; v < positions_.size(); ++v)
    velocities_[v] = (1 / dt) * moved(static_cast<std::uint32_t>(v));
}

}  // namespace sdm
