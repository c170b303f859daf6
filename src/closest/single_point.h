// Closest points of points that are far from each other, compared with the faces themselves.
#pragma once

#include <sdm/sites.h>

#include <span>
#include <vector>

#include "sites/sites_data.h"
#include "tree/visit.h"

namespace sdm::closest {

/// Per-thread memory, reused between points.
struct SinglePointMemory {
  static constexpr std::size_t kPacket = 16;  ///< points that are searched together

  /// A face that may be the closest one of one of the points, by a bound on its distance in single precision:
  /// the squared distance, or what a search from afar has in its place.
  struct Candidate {
    float bound;
    std::uint32_t face, leaf, point;
  };
  /// A node or leaf whose turn has not come, by its place in the node above, where its box is.
  struct Open {
    const tree::WideTree::Node* above = nullptr;  ///< null for the root
    std::uint32_t slot = 0, child = 0;
    float bound = 0;

    static Open of(const Open& /*parent*/, const tree::WideTree::Node& node, std::uint32_t slot,
                   float bound) {
      return {&node, slot, node.child[slot], bound};
    }
    [[nodiscard]] bool leaf() const { return tree::WideTree::is_leaf(child); }
    [[nodiscard]] std::uint32_t leaf_number() const { return tree::WideTree::leaf_number(child); }
  };
  std::vector<tree::OpenNode> stack;
  std::vector<Open> open;
  std::vector<Candidate> candidates;
};

/// The closest point of O2, if it is within max_distance, otherwise the type none: by closest_on_face(), in
/// double precision, of the faces that cannot be told apart in single precision. Of faces with the same
/// distance, the first one in the order of the search is selected, nearest box first. Cost: a traversal of
/// the tree; a group of points (descent.h) costs less for each if they are much closer together than the
/// faces.
[[nodiscard]] ClosestPoint closest_point(const sites::SitesData& sites, const Vec3& query,
                                         double max_distance);

/// A point of O2 within `enough`, not necessarily the closest one, if there is any; otherwise,
/// closest_point().
[[nodiscard]] ClosestPoint close_point(const sites::SitesData& sites, const Vec3& query, double max_distance,
                                       double enough);

/// Which faces each point of a packet excludes: groups of faces, as bits.
struct ExcludedFaces {
  std::span<const std::uint32_t> group_of;  ///< of each face
  std::span<const std::uint16_t> by;        ///< of each group: a bit for each point that excludes it
  std::span<const std::uint8_t>
      closed;  ///< of each wide node: a bit for each child whose faces all points exclude

  [[nodiscard]] bool excludes(std::size_t point, std::uint32_t face) const {
    return (by[group_of[face]] >> point & 1) != 0;
  }
};

/// Sets found[i] to the closest point of the faces that points[i] does not exclude, as closest_point() does,
/// or to the type none. Of at most a packet of points. Before, `found` has the type none, or closest points
/// that were found for others nearby, which bound the search.
void closest_of_packet(const sites::SitesData& sites, std::span<const Vec3> points, double max_distance,
                       const ExcludedFaces& excluded, std::span<ClosestPoint> found);

/// What packets of points were compared with.
struct PacketWork {
  std::size_t leaves = 0;  ///< that were near to any point of their packets
  std::size_t pairs = 0;   ///< of a point and a leaf near to it
  std::size_t far = 0;     ///< points many sizes of O2 away, which are searched by themselves
};

/// Sets found[i] to closest_point(queries[i]) for each i of `order`; `face` may be another one of the same
/// site. Costs less if queries that follow each other are near each other.
PacketWork closest_of_each(const sites::SitesData& sites, std::span<const Vec3> queries,
                           std::span<const std::uint32_t> order, double max_distance,
                           std::span<ClosestPoint> found);

}  // namespace sdm::closest
