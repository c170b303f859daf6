// Finds the nearest face of a mesh that a given face does not exclude.
#pragma once

#include <sdm/self_proximity_query.h>

#include <algorithm>
#include <vector>

#include "core/arrays/rows.h"
#include "sites/sites_data.h"

namespace sdm::self {

/// The closest points of two faces.
struct FacePair {
  double distance = std::numeric_limits<double>::infinity();
  std::uint32_t face1 = kNone, face2 = kNone;  ///< the smaller index first; kNone: there is no pair
  Vec3 point1{}, point2{};

  /// Orders pairs by distance, then by faces, so that every set of pairs has a unique first one.
  [[nodiscard]] bool before(const FacePair& other) const;
};

/// How the patches of an exclusion lie in the tree of faces. Refits do not change it.
struct PatchTree {
  /// Cost: linear.
  PatchTree(const sites::SitesData& sites, const Exclusion& exclusion);

  /// A place in the tree: 8 · wide node + slot.
  CompressedRows<std::uint32_t>
      whole;                           ///< of each patch, the places with nothing but its faces, topmost only
  CompressedRows<std::uint32_t> part;  ///< of each patch, the leaf of each of its other faces
  /// The places of each leaf and each wide node; kNone for the root.
  std::vector<std::uint32_t> place_of_leaf, place_of_node;
  std::vector<std::uint32_t> order;  ///< patches, in the order in which the tree has their first faces
};

/// A grain for loops over patches, which have as many faces on average as there are.
[[nodiscard]] inline std::size_t grain_of_patches(const Exclusion& exclusion) {
  constexpr std::size_t kFaces = 256;
  return std::clamp<std::size_t>(kFaces * exclusion.patches() / exclusion.faces(), 1, kFaces);
}

/// Per-thread searches, each starting from a face. The memory is kept between searches and between objects.
class SelfSearch {
 public:
  /// The arguments must outlive it. At most one per thread at a time.
  SelfSearch(const sites::SitesData& sites, const Exclusion& exclusion, const PatchTree& patches);
  ~SelfSearch();
  SelfSearch(const SelfSearch&) = delete;
  SelfSearch& operator=(const SelfSearch&) = delete;

  /// Sets the face whose neighbourhood is excluded. Cost: that of the tree above this neighbourhood, or
  /// nothing if the face before was of the same patch.
  void start_from(std::uint32_t face);

  /// Collects the faces that can be closest to any point of a ball.
  void gather(const Vec3& centre, double radius, double max_distance);
  /// The closest point to a point of that ball, within the same distance.
  [[nodiscard]] ClosestPoint closest_to(const Vec3& q) const;

  /// The nearest face to the face of start_from(), within max_distance; of pairs that touch, the first one.
  /// None where it is not before `known`, a pair that touches.
  [[nodiscard]] FacePair nearest(double max_distance, const FacePair& known = {}) const;

 private:
  struct Scratch;
  void exclude_patches();
  void admit_patches();
  void close(std::uint32_t place);
  void open(std::uint32_t place);
  /// Whether the box of a face shows that it is farther than this.
  [[nodiscard]] bool beyond(std::uint32_t face, const Vec3& q, double limit) const;
  template <class Visit>
  void visit_near(const Box& box, double& limit, const Visit& visit) const;

  const sites::SitesData& sites_;
  const Exclusion& exclusion_;
  const PatchTree& patches_;
  Scratch& scratch_;
  std::uint32_t face_ = kNone, patch_ = kNone;
  Vec3 centre_{};
  double max_distance_ = 0;
  std::uint32_t before_ = kNone;  ///< the closest face that gather() last found
};

}  // namespace sdm::self
