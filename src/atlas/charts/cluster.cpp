#include "atlas/charts/cluster.h"

#include <algorithm>
#include <numeric>
#include <queue>

#include "atlas/charts/normal_cone.h"
#include "core/geometry/vec.h"
#include "core/parallel.h"
#include "core/scattered_order.h"

namespace sdm::atlas {
namespace {

// Normals of a chart stay inside the cone by this margin, so that rounding cannot move them out of it.
constexpr double kMargin = 1e-9;
constexpr int kRounds = 2;
// How much slower a chart grows over faces turned away from its axis.
constexpr double kTurnCost = 4;

struct Link {
  std::uint32_t from, to;
  double length;  ///< of the border that the two clusters share
};

class Clustering {
 public:
  Clustering(const Mesh& mesh, const FaceGeometry& faces, double cos_angle)
      : mesh_(mesh), faces_(faces), cos_(cos_angle + kMargin), label_(faces.normal.size(), kNone) {}

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
  [[nodiscard]] bool fits(std::uint32_t face, const Vec3& axis) const {
    // A single face fits its own normal despite rounding.
    return dot(faces_.normal[face], axis) >= std::min(cos_, 1 - 1e-12);
  }

  // Every face without a cluster starts one, with its normal as the axis, which grows as far as possible.
  void flood_rest() {
    std::vector<std::uint32_t> stack;
    for (const std::uint32_t seed : scattered_order(label_.size())) {
      if (label_[seed] != kNone || faces_.area[seed] == 0) continue;
      const auto cluster = static_cast<std::uint32_t>(axes_.size());
      const Vec3 axis = faces_.normal[seed];
      axes_.push_back(axis);
      label_[seed] = cluster;
      stack.push_back(seed);
      while (!stack.empty()) {
        const std::uint32_t face = stack.back();
        stack.pop_back();
        for (const std::uint32_t next : faces_.neighbours[face])
          if (next != kNone && label_[next] == kNone && faces_.area[next] > 0 && fits(next, axis)) {
            label_[next] = cluster;
            stack.push_back(next);
          }
      }
    }
  }

  // Grows all clusters simultaneously from their most central faces; each face joins the cluster that is
  // nearest along the surface.
  void regrow() {
    struct Front {
      double cost;
      std::uint32_t face, cluster;
      bool operator>(const Front& other) const { return cost > other.cost; }
    };
    const std::vector<std::uint32_t> seeds = central_faces();
    std::fill(label_.begin(), label_.end(), kNone);
    std::vector<Front> heap;
    for (std::uint32_t c = 0; c < seeds.size(); ++c) heap.push_back({0, seeds[c], c});
    std::priority_queue<Front, std::vector<Front>, std::greater<>> queue({}, std::move(heap));
    while (!queue.empty()) {
      const Front front = queue.top();
      queue.pop();
      if (label_[front.face] != kNone) continue;
      label_[front.face] = front.cluster;
      for (const std::uint32_t next : faces_.neighbours[front.face])
        if (next != kNone && label_[next] == kNone && faces_.area[next] > 0 &&
            fits(next, axes_[front.cluster])) {
          const double turn = 1 - dot(faces_.normal[next], axes_[front.cluster]);
          const double step = norm(faces_.centroid[next] - faces_.centroid[front.face]);
          queue.push({front.cost + step * (1 + kTurnCost * turn), next, front.cluster});
        }
    }
    drop_empty_clusters();
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
    std::vector<std::uint8_t> grown(axes_.size(), 1);
    for (bool merged = true; merged;) {
      merged = false;
      std::vector<std::uint8_t> busy(axes_.size(), 0);
      for (const std::uint32_t c : by_area(area, target)) {
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
      for (std::uint32_t& l : label_)
        if (l != kNone) l = target[l];
      grown = std::move(busy);
    }
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

  // The clusters that were not merged into others, the smallest first.
  [[nodiscard]] static std::vector<std::uint32_t> by_area(const std::vector<double>& area,
                                                          const std::vector<std::uint32_t>& target) {
    std::vector<std::uint32_t> order;
    for (std::uint32_t c = 0; c < target.size(); ++c)
      if (target[c] == c) order.push_back(c);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return area[a] < area[b]; });
    return order;
  }

  // Moves faces with two sides on the same other cluster to that cluster: borders get shorter (triangle
  // inequality), and no cluster falls apart, as such a face is connected to its own cluster by at most one
  // side.
  void straighten_borders() {
    constexpr int kSweeps = 4;
    for (int sweep = 0; sweep < kSweeps; ++sweep)
      for (std::uint32_t f = 0; f < label_.size(); ++f) {
        if (label_[f] == kNone) continue;
        const auto [a, b, c] = faces_.neighbours[f];
        const auto label = [&](std::uint32_t face) { return face == kNone ? kNone : label_[face]; };
        const std::uint32_t twice = label(a) == label(b) || label(a) == label(c) ? label(a) : label(b);
        const bool is_twice = (label(a) == twice) + (label(b) == twice) + (label(c) == twice) >= 2;
        if (is_twice && twice != kNone && twice != label_[f] && fits(f, axes_[twice])) label_[f] = twice;
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
  double cos_;
  std::vector<std::uint32_t> label_;  // the cluster of each face
  std::vector<Vec3> axes_;            // of each cluster
};

}  // namespace

std::vector<Chart> cluster_faces(const Mesh& mesh, const FaceGeometry& faces, double cos_angle) {
  return Clustering(mesh, faces, cos_angle).run();
}

}  // namespace sdm::atlas
