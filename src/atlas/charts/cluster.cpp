#include "atlas/charts/cluster.h"

#include <hwy/cache_control.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "atlas/charts/bucket_queue.h"
#include "atlas/charts/normal_cone.h"
#include "core/arrays/rows.h"
#include "core/cancellation.h"
#include "core/parallel.h"
#include "core/scattered_order.h"
#include "geometry/unit_frame.h"

namespace sdm::atlas {
namespace {

// Normals of a chart stay inside the cone by this margin, so that rounding to float cannot move them out of
// it.
constexpr double kMargin = 1e-6;
constexpr int kRounds = 2;
constexpr std::uint32_t kPolled = 4096;  // faces
// So many clusters come from a rough surface. Each of them, grown about the normal of one face, is too wide
// to be merged with another; grown again beside all the others, they are not.
constexpr std::size_t kManyClusters = 4096;
// How much slower a chart grows over faces turned away from its axis.
constexpr double kTurnCost = 4;

// The border that a cluster shares with another one.
struct Border {
  std::uint32_t with;
  double length;
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

double float_dot(const Vec3f& a, const Vec3f& b) {
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
  FaceClusters run(std::size_t too_many) {
    flood_rest();
    const std::size_t first = axes_.size();
    if (first >= too_many) return {first, std::nullopt};
    if (axes_.size() < kManyClusters) merge();
    for (int round = 0; round < kRounds; ++round) {
      regrow();
      flood_rest();
      merge();
    }
    straighten_borders();
    return {first, charts()};
  }

 private:
  [[nodiscard]] bool fits(const Node& face, const Vec3f& axis) const {
    // A single face fits its own normal despite rounding.
    return float_dot(face.normal, axis) >= std::min(cos_, 1 - kMargin);
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
    Poll due(kPolled);
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
        due();
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
    Poll due(kPolled);
    while (const auto front = queue.pop()) {
      due();
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
        const double turn = 1 - float_dot(other.normal, axis);
        const double cost = front->cost + std::sqrt(float_dot(step, step)) * (1 + kTurnCost * turn);
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

  // Returns for each cluster the face closest to its centre of gravity.
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
  // first, each with the neighbour with which it shares the longest border. A cluster takes part in at most
  // one merge per round, so that clusters grow evenly. A pair that did not fit is tried again only after one
  // of the two has grown: a round costs no more than the clusters that grew in the one before, and their
  // neighbours.
  void merge() {
    const CompressedRows<std::uint32_t> members = faces_of_clusters();
    std::vector<NormalCone> cones = cones_of(members);
    std::vector<double> area = areas();
    std::vector<std::vector<Border>> borders = borders_of(members);
    std::vector<std::uint32_t> target(axes_.size());  // the cluster that each was merged into, or itself
    std::iota(target.begin(), target.end(), 0u);
    std::vector<std::uint8_t> grown(axes_.size(), 1), busy(axes_.size(), 0);
    std::vector<std::uint32_t> open = target;  // clusters that have grown, or have a neighbour that has
    std::vector<std::uint32_t> merged;
    std::vector<Border> choice;
    while (!open.empty()) {
      std::ranges::sort(open, {}, [&](std::uint32_t c) { return std::pair(area[c], c); });
      merged.clear();
      for (const std::uint32_t c : open) {
        if (busy[c]) continue;
        choice.clear();
        for (const Border& border : borders[c])
          if (!busy[border.with] && (grown[c] || grown[border.with])) choice.push_back(border);
        std::ranges::sort(choice, {}, [](const Border& b) { return std::pair(-b.length, b.with); });
        for (const auto& [with, length] : choice) {
          auto joined = join(cones[c], cones[with], cos_);
          if (!joined) continue;
          cones[with] = std::move(*joined);
          axes_[with] = cones[with].axis;
          area[with] += area[c];
          target[c] = with;
          busy[c] = busy[with] = 1;
          merged.push_back(c);
          break;
        }
      }
      for (const std::uint32_t c : open) grown[c] = 0;
      open = take_over_borders(merged, target, borders);
      for (const std::uint32_t c : merged) {
        busy[target[c]] = 0;
        grown[target[c]] = 1;
      }
    }
    for (std::uint32_t& label : label_)
      while (label != kNone && target[label] != label) label = target[label] = target[target[label]];
    drop_empty_clusters();
  }

  // Gives the borders of merged clusters to their targets; returns these and their neighbours.
  static std::vector<std::uint32_t> take_over_borders(std::span<const std::uint32_t> merged,
                                                      std::span<const std::uint32_t> target,
                                                      std::vector<std::vector<Border>>& borders) {
    std::vector<std::uint32_t> changed;
    for (const std::uint32_t c : merged) {
      std::vector<Border>& into = borders[target[c]];
      into.insert(into.end(), borders[c].begin(), borders[c].end());
      borders[c] = {};
    }
    for (const std::uint32_t c : merged) {
      changed.push_back(target[c]);
      for (const Border& border : borders[target[c]]) changed.push_back(target[border.with]);
    }
    std::ranges::sort(changed);
    changed.erase(std::ranges::unique(changed).begin(), changed.end());
    for (const std::uint32_t c : changed) {
      for (Border& border : borders[c]) border.with = target[border.with];
      unite(borders[c], c);
    }
    return changed;
  }

  // Sorts the borders of a cluster, adds up those with the same other one, and drops those with itself.
  static void unite(std::vector<Border>& borders, std::uint32_t cluster) {
    std::erase_if(borders, [&](const Border& border) { return border.with == cluster; });
    std::ranges::stable_sort(borders, {}, &Border::with);
    std::size_t count = 0;
    for (const Border& border : borders) {
      if (count > 0 && borders[count - 1].with == border.with)
        borders[count - 1].length += border.length;
      else
        borders[count++] = border;
    }
    borders.resize(count);
  }

  [[nodiscard]] CompressedRows<std::uint32_t> faces_of_clusters() const {
    return make_rows<std::uint32_t>(axes_.size(), [&](const auto& put) {
      for (std::uint32_t f = 0; f < label_.size(); ++f)
        if (label_[f] != kNone) put(label_[f], f);
    });
  }

  // The cones of the clusters' normals; sets the axes to theirs.
  [[nodiscard]] std::vector<NormalCone> cones_of(const CompressedRows<std::uint32_t>& members) {
    std::vector<NormalCone> cones(members.size());
    parallel_for(cones.size(), 16, [&](std::size_t begin, std::size_t end) {
      std::vector<Vec3> normals;
      for (std::size_t c = begin; c < end; ++c) {
        normals.clear();
        for (const std::uint32_t f : members.of(c)) normals.push_back(faces_.normal[f]);
        cones[c] = spanned_cone(normals, axes_[c]);
        axes_[c] = cones[c].axis;
      }
    });
    return cones;
  }

  [[nodiscard]] std::vector<std::vector<Border>> borders_of(
      const CompressedRows<std::uint32_t>& members) const {
    std::vector<std::vector<Border>> borders(members.size());
    parallel_for(borders.size(), 64, [&](std::size_t begin, std::size_t end) {
      for (auto c = static_cast<std::uint32_t>(begin); c < end; ++c) {
        for (const std::uint32_t f : members.of(c))
          for (int k = 0; k < 3; ++k) {
            const std::uint32_t next = faces_.neighbours[f][k];
            if (next == kNone || label_[next] == kNone || label_[next] == c) continue;
            const Triangle& t = mesh_.triangles[f];
            borders[c].push_back(
                {label_[next], norm(mesh_.positions[t[(k + 1) % 3]] - mesh_.positions[t[k]])});
          }
        unite(borders[c], c);
      }
    });
    return borders;
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
    const CompressedRows<std::uint32_t> members = faces_of_clusters();
    std::vector<Chart> result;
    result.reserve(axes_.size());
    for (std::size_t c = 0; c < axes_.size(); ++c)
      result.push_back({axes_[c], {members.of(c).begin(), members.of(c).end()}});
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

FaceClusters cluster_faces(const Mesh& mesh, const FaceGeometry& faces, double cos_angle,
                           std::size_t too_many) {
  return Clustering(mesh, faces, cos_angle).run(too_many);
}

}  // namespace sdm::atlas
