#include "registration/correspondences.h"

#include <algorithm>
#include <cmath>

#include "closest/blocks.h"
#include "closest/closest_points.h"
#include "core/parallel.h"
#include "sites/sites_data.h"

namespace sdm::registration {
namespace {

bool on_boundary(const ClosestPoint& c, const Target& target) {
  if (target.boundary_vertices.empty()) return false;
  if (c.type == SiteType::edge) return internals(target.sites).topology.edge_faces(c.site).size() == 1;
  return c.type == SiteType::vertex && target.boundary_vertices[c.site] != 0;
}

// The direction from the closest point to the sample, along which the distance grows; where the sample is so
// close that rounding decides it, the normal of the face.
Vec3 tangent_normal(const ClosestPoint& c, std::uint32_t face, const Vec3& point, const Target& target) {
  constexpr double kClose = 1e-9;
  const sites::SitesData& data = internals(target.sites);
  const Vec3& normal = data.normals.face[face];
  const bool has_normal = squared_norm(normal) > 0;
  if (has_normal && (c.type == SiteType::face || c.distance * data.frame.scale < kClose)) return normal;
  return normalized(point - c.point);
}

// Excludes samples whose normals differ from those of O2, if enough are left. All faces of O1 may be turned
// the other way; if that is true of some of them only, the sides of a wall cannot be told apart.
void exclude_other_sides(const Samples& samples, const Affine& pose, const Target& target,
                         Correspondences& pairs) {
  constexpr double kLeast = 0.5, kMost = 0.8, kEnough = 0.4;  // the cosine of 60°; shares of the samples
  const auto& face_normals = internals(target.sites).normals.face;
  std::vector<double> cosines(pairs.points.size());
  std::size_t known = 0, against = 0;
  for (std::size_t i = 0; i < cosines.size(); ++i) {
    if (!pairs.usable[i]) continue;
    cosines[i] = dot(pose.linear(samples.normals[i]), face_normals[pairs.faces[i]]);
    ++known;
    against += cosines[i] < 0;
  }
  const bool opposite = static_cast<double>(against) > kMost * static_cast<double>(known);
  if (opposite)
    for (double& cosine : cosines) cosine = -cosine;
  const auto agrees = [&](std::size_t i, bool either_side) {
    return (either_side ? std::abs(cosines[i]) : cosines[i]) >= kLeast;
  };
  for (const bool either_side : {false, true}) {
    std::size_t left = 0;
    for (std::size_t i = 0; i < cosines.size(); ++i) left += pairs.usable[i] && agrees(i, either_side);
    if (static_cast<double>(left) < kEnough * static_cast<double>(known)) continue;
    for (std::size_t i = 0; i < cosines.size(); ++i)
      pairs.usable[i] = pairs.usable[i] && agrees(i, either_side);
    return;
  }
}

bool in_region(const AlignRegion& region, std::uint32_t face, const Vec3& point) {
  if (!region.faces.empty() && region.faces[face] != 0) return true;
  return std::ranges::any_of(region.boxes, [&](const Box& box) {
    for (int k = 0; k < 3; ++k)
      if (!(point[k] >= box.lower[k] && point[k] <= box.upper[k])) return false;
    return true;
  });
}

void select_region(const AlignRegion& region, Correspondences& pairs) {
  pairs.selected.resize(pairs.points.size());
  for (std::size_t i = 0; i < pairs.points.size(); ++i) {
    pairs.selected[i] = in_region(region, pairs.faces[i], pairs.closest[i]);
    pairs.usable[i] = pairs.usable[i] && pairs.selected[i];
  }
}

// The number of the part of the unit sphere that a direction is in: a square on a side of the cube around it.
std::size_t direction_cell(const Vec3& direction) {
  constexpr std::size_t kSquares = 4;  // along a side
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (std::abs(direction[k]) > std::abs(direction[axis])) axis = k;
  const double depth = std::abs(direction[axis]);
  const auto square = [&](std::size_t k) {
    const double x = depth > 0 ? 0.5 * (direction[k] / depth + 1) : 0;
    return std::min(kSquares - 1, static_cast<std::size_t>(x * kSquares));
  };
  const std::size_t side = 2 * axis + (direction[axis] < 0 ? 1 : 0);
  return (side * kSquares + square((axis + 1) % 3)) * kSquares + square((axis + 2) % 3);
}

}  // namespace

Target::Target(const Sites& o2) : sites(o2) {
  if (o2.closed()) return;
  const sites::SitesData& data = internals(o2);
  boundary_vertices.assign(data.mesh.positions.size(), 0);
  for (std::size_t edge = 0; edge < data.topology.edges.size(); ++edge)
    if (data.topology.edge_faces(edge).size() == 1)
      for (const std::uint32_t v : data.topology.edges[edge]) boundary_vertices[v] = 1;
}

Correspondences find_correspondences(const Samples& samples, const Affine& pose, const Target& target) {
  const sites::SitesData& data = internals(target.sites);
  const std::size_t count = samples.points.size();
  Correspondences pairs{std::vector<Vec3>(count),
                        std::vector<Vec3>(count),
                        std::vector<Vec3>(count),
                        std::vector<double>(count),
                        std::vector<std::uint32_t>(count),
                        std::vector<std::uint8_t>(count),
                        {}};
  for (std::size_t i = 0; i < count; ++i) pairs.points[i] = pose(samples.points[i]);
  const auto store = [&](std::size_t i, const ClosestPoint& c) {
    pairs.distances[i] = c.distance;
    pairs.closest[i] = c.point;
    pairs.faces[i] = data.face_of(c.type, c.site);
    pairs.normals[i] = tangent_normal(c, pairs.faces[i], pairs.points[i], target);
    pairs.usable[i] = !on_boundary(c, target);
  };
  closest::for_each_block(count, {}, "align", [&](std::size_t begin, std::size_t end) {
    const std::span<const Vec3> block = std::span(pairs.points).subspan(begin, end - begin);
    closest::closest_points(data, block, kInfinity,
                            [&](std::size_t first, const sites::ClosestPacket& packet) {
                              for (std::size_t k = 0; k < packet.count; ++k) {
                                const std::size_t i = begin + first + k;
                                store(i, packet.get(k, pairs.points[i]));
                              }
                            });
  });
  // Where O1 is far from its place, or O2 is a soup, most of the samples may be beside it.
  if (4 * static_cast<std::size_t>(std::ranges::count(pairs.usable, 1)) < count)
    std::ranges::fill(pairs.usable, std::uint8_t{1});
  if (!samples.normals.empty()) exclude_other_sides(samples, pose, target, pairs);
  if (target.region) select_region(*target.region, pairs);
  return pairs;
}

Correspondences thinned(const Correspondences& pairs, std::size_t most) {
  std::vector<std::size_t> selected;
  for (std::size_t i = 0; i < pairs.points.size(); ++i)
    if (pairs.is_selected(i)) selected.push_back(i);
  const std::size_t count = std::min(most, selected.size());
  if (count < selected.size()) {
    // Equal steps through samples sorted by the directions of their normals take the share of each direction.
    std::vector<std::size_t> cells(pairs.points.size());
    for (const std::size_t i : selected) cells[i] = direction_cell(pairs.normals[i]);
    std::ranges::stable_sort(selected, {}, [&](std::size_t i) { return cells[i]; });
  }
  Correspondences result;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = selected[(2 * k + 1) * selected.size() / (2 * count)];
    result.points.push_back(pairs.points[i]);
    result.closest.push_back(pairs.closest[i]);
    result.normals.push_back(pairs.normals[i]);
    result.distances.push_back(pairs.distances[i]);
    result.faces.push_back(pairs.faces[i]);
    result.usable.push_back(pairs.usable[i]);
  }
  return result;
}

std::vector<Vec3> smooth_normals(const Correspondences& pairs, const Sites& o2) {
  constexpr double kSmooth = 0.82;  // the cosine of 35°
  const sites::SitesData& data = internals(o2);
  std::vector<Vec3> result(pairs.points.size());
  constexpr std::size_t kGrain = 256;
  parallel_for(result.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t face = pairs.faces[i];
      const Triangle& t = data.mesh.triangles[face];
      const Vec3& normal = data.normals.face[face];
      std::array<Vec3, 3> p;
      for (int k = 0; k < 3; ++k) p[k] = data.mesh.positions[t[k]];
      Vec3 sum{};
      for (int k = 0; k < 3; ++k) {
        Vec3 at_corner{};
        for (const std::uint32_t other : data.vertex_faces.of(t[k])) {
          if (!(std::abs(dot(data.normals.face[other], normal)) > kSmooth)) continue;
          const Triangle& u = data.mesh.triangles[other];
          const int corner = u[0] == t[k] ? 0 : u[1] == t[k] ? 1 : 2;
          const Vec3 a = normalized(data.mesh.positions[u[(corner + 1) % 3]] - p[k]);
          const Vec3 b = normalized(data.mesh.positions[u[(corner + 2) % 3]] - p[k]);
          const double angle = std::acos(std::clamp(dot(a, b), -1.0, 1.0));
          at_corner += std::copysign(angle, dot(data.normals.face[other], normal)) * data.normals.face[other];
        }
        // Barycentric coordinates by areas, of a face with an area.
        const Vec3 area = cross(p[(k + 1) % 3] - pairs.closest[i], p[(k + 2) % 3] - pairs.closest[i]);
        sum += std::abs(dot(area, normal)) * normalized(at_corner);
      }
      result[i] = squared_norm(sum) > 0 ? normalized(sum) : normal;
    }
  });
  return result;
}

}  // namespace sdm::registration
