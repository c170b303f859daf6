#include "certify/hausdorff/vertex_search.h"

#include <algorithm>
#include <cmath>

#include "certify/hausdorff/nearest_face.h"
#include "closest/blocks.h"
#include "closest/closest_points.h"
#include "core/parallel.h"
#include "geometry/rounding.h"
#include "geometry/spatial_order.h"

namespace sdm::hausdorff {
namespace {

class VertexSearch {
 public:
  VertexSearch(const Mesh& a, const sites::SitesData& b, const Progress& progress, LowerBound& lower)
      : a_(a), b_(b), progress_(progress), lower_(lower) {}

  std::vector<VertexDistance> operator()() {
    find_vertices();
    distances_.resize(a_.positions.size());
    std::vector<Group> groups;
    constexpr std::size_t kLargest = 256, kFan = 16;  // aligned groups of either size are small boxes
    for (std::size_t begin = 0; begin < vertices_.size(); begin += kLargest)
      groups.push_back({begin, std::min(begin + kLargest, vertices_.size())});
    for (std::size_t size = kLargest; size > 1; size /= kFan) {
      measure_middles(groups);
      groups = divide(groups, size / kFan);
    }
    constexpr std::size_t kFew = 1024;  // single vertices: fewer are far from each other
    if (groups.size() < kFew)
      measure_middles(groups);
    else
      measure_vertices(groups);
    return std::move(distances_);
  }

 private:
  /// A range of vertices_.
  struct Group {
    std::size_t begin, end;
    std::uint32_t near = kNone;  // a face of B near it, if known
    [[nodiscard]] std::size_t middle() const { return begin + (end - begin) / 2; }
  };
  struct Vertex {
    Vec3 at;
    double radius;  // no point of its faces is farther from it
    std::uint32_t index, face;
  };

  // The vertices of faces, in spatial order.
  void find_vertices() {
    std::vector<double> squared_radius(a_.positions.size(), -1);
    std::vector<std::uint32_t> face_of(a_.positions.size(), kNone);
    for (std::size_t f = 0; f < a_.triangles.size(); ++f) {
      const Triangle& t = a_.triangles[f];
      if (repeats_corner(t)) continue;
      Vec3 length;
      for (int k = 0; k < 3; ++k) length[k] = squared_norm(a_.positions[t[(k + 1) % 3]] - a_.positions[t[k]]);
      for (int k = 0; k < 3; ++k) {
        squared_radius[t[k]] = std::max({squared_radius[t[k]], length[k], length[(k + 2) % 3]});
        face_of[t[k]] = static_cast<std::uint32_t>(f);
      }
    }
    std::vector<Vec3> points;
    std::vector<std::uint32_t> index;
    for (std::uint32_t v = 0; v < a_.positions.size(); ++v)
      if (face_of[v] != kNone) {
        points.push_back(a_.positions[v]);
        index.push_back(v);
      }
    vertices_.reserve(points.size());
    for (const std::uint32_t i : spatial_order(points)) {
      const std::uint32_t v = index[i];
      vertices_.push_back({points[i], (1 + kFewRoundings) * std::sqrt(squared_radius[v]), v, face_of[v]});
    }
  }

  // Computes the distances of the middle vertices of the groups. These are far from each other, so each is
  // searched by itself, starting at the face found for the group around.
  void measure_middles(const std::vector<Group>& groups) {
    std::vector<NearestFace> nearest(groups.size());
    constexpr std::size_t kGrain = 8;
    parallel_for(groups.size(), kGrain, progress_, "vertices", [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Vertex& vertex = vertices_[groups[i].middle()];
        nearest[i] = nearest_face(b_, vertex.at, groups[i].near == kNone ? b_.tree.items[0] : groups[i].near);
        distances_[vertex.index] = {nearest[i].upper, nearest[i].face, nearest[i].face, SiteType::face};
      }
    });
    for (std::size_t i = 0; i < groups.size(); ++i) {
      const Vertex& vertex = vertices_[groups[i].middle()];
      lower_.raise(vertex.at, 0, vertex.face, nearest[i]);
    }
  }

  // Computes the distances of groups of one vertex each, neighbours together.
  void measure_vertices(const std::vector<Group>& groups) {
    points_.clear();
    measured_.clear();
    for (const Group& group : groups) {
      points_.push_back(vertices_[group.begin].at);
      measured_.push_back(group.begin);
    }
    closest::for_each_block(points_.size(), progress_, "vertices", [&](std::size_t begin, std::size_t end) {
      closest::closest_points(b_, std::span(points_).subspan(begin, end - begin), kInfinity,
                              [&](std::size_t first, const sites::ClosestPacket& closest) {
                                for (std::size_t i = 0; i < closest.count; ++i) {
                                  const std::uint32_t face = b_.face_of(closest.type[i], closest.site[i]);
                                  const Vec3& p = points_[begin + first + i];
                                  distances_[vertices_[measured_[begin + first + i]].index] = {
                                      upper_face_distance(p, corners_of(b_.mesh, face)), face,
                                      closest.site[i], closest.type[i]};
                                }
                              });
    });
    raise_lower_bound();
  }

  // Distances are upper bounds: the lower bound is computed anew at the vertices with the largest ones.
  void raise_lower_bound() {
    constexpr int kMost = 16;  // more than one only if the engine's closest face is not the closest
    const auto upper = [&](std::size_t i) { return distances_[vertices_[i].index].upper; };
    for (int n = 0; n < kMost && !measured_.empty(); ++n) {
      const auto highest = std::ranges::max_element(measured_, {}, upper);
      const Vertex& vertex = vertices_[*highest];
      VertexDistance& distance = distances_[vertex.index];
      if (distance.upper <= (1 + kProductRounding) * lower_.value) return;
      const NearestFace nearest = nearest_face(b_, vertex.at, distance.face);
      lower_.raise(vertex.at, 0, vertex.face, nearest);
      if (nearest.upper < distance.upper)
        distance = {nearest.upper, nearest.face, nearest.face, SiteType::face};
      *highest = measured_.back();
      measured_.pop_back();
    }
  }

  // The parts of groups, of this size, with a vertex v whose faces may exceed the lower bound: d(p) ≤ d(v) +
  // |p − v|, and d(v) is at most d(middle) + |v − middle|, and at most the distance to the face found there.
  [[nodiscard]] std::vector<Group> divide(const std::vector<Group>& groups, std::size_t size) const {
    std::vector<Group> parts;
    for (const Group& group : groups) {
      const Vertex& middle = vertices_[group.middle()];
      const double distance = distances_[middle.index].upper;
      const Corners near = corners_of(b_.mesh, distances_[middle.index].face);
      for (std::size_t begin = group.begin; begin < group.end; begin += size) {
        const Group part{begin, std::min(begin + size, group.end), distances_[middle.index].face};
        for (std::size_t i = part.begin; i < part.end; ++i) {
          const Vertex& v = vertices_[i];
          if ((1 + kProductRounding) * (distance + norm(v.at - middle.at) + v.radius) <= lower_.value)
            continue;
          if ((1 + kProductRounding) * (upper_face_distance(v.at, near) + v.radius) <= lower_.value) continue;
          parts.push_back(part);
          break;
        }
      }
    }
    return parts;
  }

  const Mesh& a_;
  const sites::SitesData& b_;
  const Progress& progress_;
  LowerBound& lower_;
  std::vector<Vertex> vertices_;
  std::vector<VertexDistance> distances_;  // by vertices of A
  std::vector<Vec3> points_;               // of a batch
  std::vector<std::size_t> measured_;      // their places in vertices_
};

}  // namespace

std::vector<VertexDistance> search_vertices(const Mesh& a, const sites::SitesData& b,
                                            const Progress& progress, LowerBound& lower) {
  return VertexSearch(a, b, progress, lower)();
}

}  // namespace sdm::hausdorff
