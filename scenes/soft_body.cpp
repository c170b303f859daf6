#include "scenes/soft_body.h"

#include <algorithm>

namespace sdm::scenes {
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

  // Each seed is the vertex farthest from the previous seeds; once there are enough clusters, a vertex that
  // is in none.
  const auto neighbours = neighbours_of(mesh);
  masses_.assign(n, 0);  // for now, the number of clusters of each vertex
  std::vector<double> to_seed(n, kInfinity);
  std::size_t seed = 0;
  while (seed < n) {
    add_cluster(neighbours, static_cast<std::uint32_t>(seed), material.cluster_radius);
    for (std::size_t v = 0; v < n; ++v)
      to_seed[v] = std::min(to_seed[v], norm(positions_[v] - positions_[seed]));
    const auto farthest = std::ranges::max_element(to_seed) - to_seed.begin(),
               uncovered = std::ranges::find(masses_, 0.0) - masses_.begin();
    seed = static_cast<std::size_t>(clusters_.size() < material.clusters ? farthest : uncovered);
  }
  for (double& mass : masses_) mass = 1 / mass;

  for (Cluster& cluster : clusters_) {
    Vec3 sum{};
    double mass = 0;
    for (const std::uint32_t v : cluster.vertices) {
      sum += masses_[v] * positions_[v];
      mass += masses_[v];
    }
    for (const std::uint32_t v : cluster.vertices) cluster.rest.push_back(positions_[v] - (1 / mass) * sum);
  }
}

// The vertices within the radius that are connected to the seed through such vertices, so that no cluster
// joins two arms of the E.
void SoftBody::add_cluster(const std::vector<std::vector<std::uint32_t>>& neighbours, std::uint32_t seed,
                           double radius) {
  std::vector<std::uint32_t>& vertices = clusters_.emplace_back().vertices;
  std::vector<bool> visited(positions_.size(), false);
  vertices.push_back(seed);
  visited[seed] = true;
  for (std::size_t i = 0; i < vertices.size(); ++i)
    for (const std::uint32_t w : neighbours[vertices[i]]) {
      if (visited[w] || norm(positions_[w] - positions_[seed]) > radius) continue;
      visited[w] = true;
      vertices.push_back(w);
    }
  for (const std::uint32_t v : vertices) ++masses_[v];
}

void SoftBody::begin_step(double dt) {
  previous_ = positions_;
  for (std::size_t v = 0; v < positions_.size(); ++v) positions_[v] += dt * velocities_[v];
}

void SoftBody::match_shapes() {
  std::ranges::fill(pulls_, Vec3{});
  for (Cluster& cluster : clusters_) {
    Vec3 centre{};
    double mass = 0;
    for (const std::uint32_t v : cluster.vertices) {
      centre += masses_[v] * positions_[v];
      mass += masses_[v];
    }
    centre = (1 / mass) * centre;
    Matrix moment{};  // Σ m (x − centre) restᵀ
    for (std::size_t i = 0; i < cluster.vertices.size(); ++i) {
      const std::uint32_t v = cluster.vertices[i];
      for (int k = 0; k < 3; ++k) moment[k] += (masses_[v] * cluster.rest[i][k]) * (positions_[v] - centre);
    }
    cluster.rotation = rotation_part(moment, cluster.rotation);
    for (std::size_t i = 0; i < cluster.vertices.size(); ++i) {
      const std::uint32_t v = cluster.vertices[i];
      pulls_[v] += masses_[v] * (centre + cluster.rotation * cluster.rest[i] - positions_[v]);
    }
  }
  for (std::size_t v = 0; v < positions_.size(); ++v) positions_[v] += stiffness_ * pulls_[v];
}

void SoftBody::end_step(double dt) {
  for (std::size_t v = 0; v < positions_.size(); ++v)
    velocities_[v] = (1 / dt) * displacement(static_cast<std::uint32_t>(v));
}

}  // namespace sdm::scenes
