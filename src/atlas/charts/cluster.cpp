#include "atlas/charts/cluster.h"

#include <hwy/cache_control.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "atlas/charts/normal_cone.h"
#include "core/bucket_queue.h"
#include "core/geometry/unit_frame.h"
#include "core/geometry/vec.h"
#include "core/parallel.h"
#include "core/scattered_order.h"

namespace sdm::atlas {
namespace {

// Normals of a chart stay inside the cone by this margin, so that rounding to float cannot move them out of
// it.
constexpr double kMargin = 1e-6;
constexpr int kRounds = 2;
// How much slower a chart grows over faces turned away from its axis.
constexpr double kTurnCost = 4;

struct Link {
  std::uint32_t from, to;
  double length;  ///< of the border that the two clusters share
};

// What growing clusters read of a face, together: they visit faces in no particular order in memory.
struct Node {
  Vec3f normal, centroid;                   ///< in the unit frame, whose squares do not overflow
  std::array<std::uint32_t, 3> neighbours;  ///< those with area
};

Vec3f to_float(const Vec3& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

std::vector<Node> to_nodes(const Mesh& mesh, const FaceGeometry& faces) {
  const UnitFrame frame = UnitFrame::of(bounds(mesh));
  std::vector<Node> nodes(faces.normal.size());
  parallel_for(nodes.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      nodes[f] = {to_float(faces.normal[f]), to_float(frame.to_unit(faces.centroid[f])), faces.neighbours[f]};
      for (std::uint32_t& next : nodes[f].neighbours)
        if (next != kNone && faces.area[next] == 0) next = kNone;
    }
  });
  return nodes;
}

double dot(const Vec3f& a, const Vec3f& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

class Clustering {
 public:
  Clustering(const Mesh& mesh, const FaceGeometry& faces, double cos_angle)
      : mesh_(mesh),
        faces_(faces),
        nodes_(to_nodes(mesh, faces)),
        cos_(cos_angle + kMargin),
        label_(faces.normal.size(), kNone) {}

  // Lloyd's alternation: the axes from the clusters, the clusters from the axes.
  std::vector<Chart> run() {
    flood_rest();
    merge();
    for (int round = 0; round < kRounds; ++round) {
      regrow();
      flood_rest();
      merge();
    }
    straighten_borders();
    return charts();
  }

 private:
  [[nodiscard]] bool fits(const Node& face, const Vec3f& axis) const {
    // A single face fits its own normal despite rounding.
    return dot(face.normal, axis) >= std::min(cos_, 1 - kMargin);
  }

  // Faces that will be visited soon: growing clusters waits for memory most of the time.
  static constexpr std::size_t kAhead = 8;
  void prefetch(std::uint32_t face) const {
    hwy::Prefetch(&nodes_[face]);
    hwy::Prefetch(&label_[face]);
  }
  void prefetch_neighbours(std::uint32_t face) const {
    for (const std::uint32_t next : nodes_[face].neighbours)
      if (next != kNone) prefetch(next);
  }

  // Every face without a cluster starts one, with its normal as the axis, which grows as far as possible.
  void flood_rest() {
    std::vector<std::uint32_t> queue;
    for (const std::uint32_t seed : scattered_order(label_.size())) {
      if (label_[seed] != kNone || faces_.area[seed] == 0) continue;
      const auto cluster = static_cast<std::uint32_t>(axes_.size());
      const Vec3f axis = nodes_[seed].normal;
      axes_.push_back(faces_.normal[seed]);
      label_[seed] = cluster;
      queue.assign(1, seed);
      for (std::size_t i = 0; i < queue.size(); ++i) {
        if (i + 2 * kAhead < queue.size()) prefetch(queue[i + 2 * kAhead]);
        if (i + kAhead < queue.size()) prefetch_neighbours(queue[i + kAhead]);
        const std::uint32_t face = queue[i];
        for (const std::uint32_t next : nodes_[face].neighbours)
          if (next != kNone && label_[next] == kNone && fits(nodes_[next], axis)) {
            label_[next] = cluster;
            queue.push_back(next);
          }
      }
    }
  }

  // Grows all clusters simultaneously from their most central faces; each face joins the cluster that is
  // nearest along the surface, up to a fraction of a face.
  void regrow() {
    struct Front {
      float cost;
      std::uint32_t face, cluster;
    };
    const std::vector<std::uint32_t> seeds = central_faces();
    std::vector<Vec3f> axes(axes_.size());
    std::ranges::transform(axes_, axes.begin(), to_float);
    std::fill(label_.begin(), label_.end(), kNone);
    BucketQueue<Front> queue(typical_step() / 4);
    for (std::uint32_t c = 0; c < seeds.size(); ++c) queue.push(0, {0, seeds[c], c});
    while (const auto front = queue.pop()) {
      if (const Front* ahead = queue.ahead(2 * kAhead)) prefetch(ahead->face);
      if (const Front* ahead = queue.ahead(kAhead)) prefetch_neighbours(ahead->face);
      if (label_[front->face] != kNone) continue;
      label_[front->face] = front->cluster;
      const Node& node = nodes_[front->face];
      for (const std::uint32_t next : node.neighbours) {
        if (next == kNone || label_[next] != kNone) continue;
        const Vec3f& axis = axes[front->cluster];
        const Node& other = nodes_[next];
        if (!fits(other, axis)) continue;
        const Vec3f step = {other.centroid[0] - node.centroid[0], other.centroid[1] - node.centroid[1],
                            other.centroid[2] - node.centroid[2]};
        const double turn = 1 - dot(other.normal, axis);
        const double cost = front->cost + std::sqrt(dot(step, step)) * (1 + kTurnCost * turn);
        queue.push(cost, {static_cast<float>(cost), next, front->cluster});
      }
    }
    drop_empty_clusters();
  }

  // The side of a square of a face's mean area, in the unit frame.
  [[nodiscard]] double typical_step() const {
    const double area = std::accumulate(faces_.area.begin(), faces_.area.end(), 0.0);
    return UnitFrame::of(bounds(mesh_)).scale * std::sqrt(area / static_cast<double>(faces_.area.size()));
  }

  // For each cluster, the face closest to its centre of gravity.
  [[nodiscard]] std::vector<std::uint32_t> central_faces() const {
    std::vector<Vec3> centre(axes_.size());
    std::vector<double> area(axes_.size());
    for (std::uint32_t f = 0; f < label_.size(); ++f)
      if (label_[f] != kNone) {
        centre[label_[f]] += faces_.area[f] * faces_.centroid[f];
        area[label_[f]] += faces_.area[f];
      }
    for (std::size_t c = 0; c < centre.size(); ++c) centre[c] = (1 / area[c]) * centre[c];
    std::vector<std::uint32_t> central(axes_.size(), kNone);
    const auto offset = [&](std::uint32_t f) { return squared_norm(faces_.centroid[f] - centre[label_[f]]); };
    for (std::uint32_t f = 0; f < label_.size(); ++f)
      if (label_[f] != kNone) {
        std::uint32_t& best = central[label_[f]];
        if (best == kNone || offset(f) < offset(best)) best = f;
      }
    return central;
  }

  // Merges pairs of neighbours whose normals fit one cone until no such pair is left: the smallest clusters
  // first, each with the neighbour with which it shares the longest border. A pair that did not fit is tried
  // again only after one of the two has grown.
  void merge() {
    std::vector<NormalCone> cones = all_cones();
    std::vector<double> area = areas();
    std::vector<Link> links = all_links();
    std::vector<std::uint32_t> target(axes_.size());  // the cluster that each was merged into, or itself
    std::iota(target.begin(), target.end(), 0u);
    std::vector<std::uint32_t> left = target;  // those that were not merged into others
    std::vector<std::uint8_t> grown(axes_.size(), 1);
    for (bool merged = true; merged;) {
      merged = false;
      std::vector<std::uint8_t> busy(axes_.size(), 0);
      std::ranges::stable_sort(left, {}, [&](std::uint32_t c) { return area[c]; });
      for (const std::uint32_t c : left) {
        if (busy[c]) continue;
        auto [first, last] = std::equal_range(links.begin(), links.end(), Link{c, 0, 0},
                                              [](const Link& a, const Link& b) { return a.from < b.from; });
        std::vector<Link> choice;
        std::copy_if(first, last, std::back_inserter(choice),
                     [&](const Link& link) { return !busy[link.to] && (grown[c] || grown[link.to]); });
        std::sort(choice.begin(), choice.end(),
                  [](const Link& a, const Link& b) { return a.length > b.length; });
        for (const Link& link : choice) {
          auto joined = join(cones[c], cones[link.to], cos_);
          if (!joined) continue;
          cones[link.to] = std::move(*joined);
          axes_[link.to] = cones[link.to].axis;
          area[link.to] += area[c];
          target[c] = link.to;
          busy[c] = busy[link.to] = 1;
          merged = true;
          break;
        }
      }
      // A cluster takes part in at most one merge per round, so that targets are not themselves merged in the
      // same round.
      for (Link& link : links) link = {target[link.from], target[link.to], link.length};
      unite(links);
      std::erase_if(left, [&](std::uint32_t c) { return target[c] != c; });
      grown = std::move(busy);
    }
    for (std::uint32_t& label : label_)
      while (label != kNone && target[label] != label) label = target[label] = target[target[label]];
    drop_empty_clusters();
  }

  [[nodiscard]] std::vector<NormalCone> all_cones() {
    const std::vector<Chart> clusters = charts();
    std::vector<NormalCone> cones(clusters.size());
    parallel_for(clusters.size(), 16, [&](std::size_t begin, std::size_t end) {
      std::vector<Vec3> normals;
      for (std::size_t c = begin; c < end; ++c) {
        normals.clear();
        for (const std::uint32_t f : clusters[c].faces) normals.push_back(faces_.normal[f]);
        cones[c] = spanned_cone(normals, axes_[c]);
        axes_[c] = cones[c].axis;
      }
    });
    return cones;
  }

  // Pairs of adjacent clusters, both ways, sorted.
  [[nodiscard]] std::vector<Link> all_links() const {
    std::vector<Link> links;
    for (std::uint32_t f = 0; f < label_.size(); ++f)
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t next = faces_.neighbours[f][k];
        if (next == kNone || label_[f] == kNone || label_[next] == kNone || label_[next] == label_[f])
          continue;
        const Triangle& t = mesh_.triangles[f];
        const double length = norm(mesh_.positions[t[(k + 1) % 3]] - mesh_.positions[t[k]]);
        links.push_back({label_[f], label_[next], length});
      }
    unite(links);
    return links;
  }

  // Sorts links, adds up those between the same two clusters, and drops those of a cluster with itself.
  static void unite(std::vector<Link>& links) {
    std::erase_if(links, [](const Link& link) { return link.from == link.to; });
    std::stable_sort(links.begin(), links.end(), [](const Link& a, const Link& b) {
      return std::pair(a.from, a.to) < std::pair(b.from, b.to);
    });
    std::size_t count = 0;
    for (const Link& link : links) {
      if (count > 0 && links[count - 1].from == link.from && links[count - 1].to == link.to)
        links[count - 1].length += link.length;
      else
        links[count++] = link;
    }
    links.resize(count);
  }

  [[nodiscard]] std::vector<double> areas() const {
    std::vector<double> area(axes_.size());
    for (std::uint32_t f = 0; f < label_.size(); ++f)
      if (label_[f] != kNone) area[label_[f]] += faces_.area[f];
    return area;
  }

  // Moves faces with two sides on the same other cluster to that cluster: borders get shorter (triangle
  // inequality), and no cluster falls apart, as such a face is connected to its own cluster by at most one
  // side.
  void straighten_borders() {
    constexpr int kSweeps = 4;
    for (int sweep = 0; sweep < kSweeps; ++sweep)
      for (std::uint32_t f = 0; f < label_.size(); ++f) {
        if (label_[f] == kNone) continue;
        const auto [a, b, c] = nodes_[f].neighbours;
        const auto label = [&](std::uint32_t face) { return face == kNone ? kNone : label_[face]; };
        const std::uint32_t twice = label(a) == label(b) || label(a) == label(c) ? label(a) : label(b);
        const bool is_twice = (label(a) == twice) + (label(b) == twice) + (label(c) == twice) >= 2;
        if (is_twice && twice != kNone && twice != label_[f] && fits(nodes_[f], to_float(axes_[twice])))
          label_[f] = twice;
      }
    drop_empty_clusters();
  }

  // Renumbers the clusters that have faces, keeping their order.
  void drop_empty_clusters() {
    std::vector<std::uint32_t> renumber(axes_.size(), kNone);
    std::uint32_t kept = 0;
    for (const std::uint32_t l : label_)
      if (l != kNone) renumber[l] = 0;
    for (std::uint32_t c = 0; c < axes_.size(); ++c)
      if (renumber[c] == 0) {
        axes_[kept] = axes_[c];
        renumber[c] = kept++;
      }
    axes_.resize(kept);
    for (std::uint32_t& l : label_)
      if (l != kNone) l = renumber[l];
  }

  [[nodiscard]] std::vector<Chart> charts() const {
    std::vector<Chart> result(axes_.size());
    for (std::size_t c = 0; c < axes_.size(); ++c) result[c].axis = axes_[c];
    for (std::uint32_t f = 0; f < label_.size(); ++f)
      if (label_[f] != kNone) result[label_[f]].faces.push_back(f);
    return result;
  }

  const Mesh& mesh_;
  const FaceGeometry& faces_;
  const std::vector<Node> nodes_;
  double cos_;
  std::vector<std::uint32_t> label_;  // the cluster of each face
  std::vector<Vec3> axes_;            // of each cluster
};

}  // namespace

std::vector<Chart> cluster_faces(const Mesh& mesh, const FaceGeometry& faces, double cos_angle) {
  return Clustering(mesh, faces, cos_angle).run();
}

}  // namespace sdm::atlas
