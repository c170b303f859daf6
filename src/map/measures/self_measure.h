// Distances of a surface to itself: to the faces of a mesh that a given face does not exclude.
#pragma once

#include <sdm/measure.h>

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "closest/single_point.h"
#include "core/arrays/rows.h"
#include "map/measure.h"
#include "sites/sites_data.h"

namespace sdm::self {

/// The closest points of two faces.
struct FacePair {
  double distance = kInfinity;
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
  std::vector<std::uint32_t> patch_of;  ///< of each face
  std::vector<std::uint32_t> order;     ///< patches, in the order in which the tree has their first faces
};

/// A grain for loops over patches, which have as many faces on average as there are.
[[nodiscard]] inline std::size_t grain_of_patches(const Exclusion& exclusion) {
  constexpr std::size_t kFaces = 256;
  return std::clamp<std::size_t>(kFaces * exclusion.patches() / exclusion.faces(), 1, kFaces);
}

/// Per-thread searches, each starting from one face or a few. The memory is kept between searches and between
/// objects.
class SelfSearch {
 public:
  static constexpr std::size_t kPacket = closest::SinglePointMemory::kPacket;

  /// The arguments must outlive it. At most one per thread at a time.
  SelfSearch(const sites::SitesData& sites, const Exclusion& exclusion, const PatchTree& patches);
  ~SelfSearch();
  SelfSearch(const SelfSearch&) = delete;
  SelfSearch& operator=(const SelfSearch&) = delete;

  /// Sets the faces whose neighbourhoods are excluded, 1 to kPacket. Cost: O(the patches of these and of the
  /// neighbourhoods before), and that of the tree above the patches that only either all of these faces or
  /// all of those before exclude; nothing if the faces before excluded the same.
  void start_from(std::span<const std::uint32_t> faces);

  /// The closest points to points on these faces, within max_distance; type none where there is none. Costs
  /// less if they are near each other and near those before. The result is valid until the next call.
  [[nodiscard]] std::span<const ClosestPoint> closest_to(std::span<const Vec3> points, double max_distance);

  /// The nearest face to the one face of start_from(), within max_distance; of pairs that touch, the first
  /// one. None where it is not before `known`, a pair that touches.
  [[nodiscard]] FacePair nearest(double max_distance, const FacePair& known = {}) const;

 private:
  struct Scratch;
  /// The patches that each face of a packet excludes; several faces may have the same. Empty before the first
  /// packet.
  using Rows = std::array<std::span<const std::uint32_t>, kPacket>;

  void exclude(const Rows& rows);
  void exclude_patch(std::uint32_t patch);
  void admit_patch(std::uint32_t patch);
  void close(std::uint32_t place);
  void open(std::uint32_t place);
  [[nodiscard]] bool all_closed(std::uint32_t node) const;
  template <class Visit>
  void visit_near(const Box& box, double& limit, const Visit& visit) const;

  const sites::SitesData& sites_;
  const Exclusion& exclusion_;
  const PatchTree& patches_;
  Scratch& scratch_;
  std::uint32_t face_ = kNone;  ///< the first one of start_from()
  Rows rows_{};
  std::array<ClosestPoint, kPacket> closest_{};  ///< that closest_to() last found
};

class SelfMeasure final : public map::FaceMeasure {
 public:
  /// All must outlive this. Throws sdm::Error for options that do not apply.
  SelfMeasure(const Mesh& mesh, const Sites& sites, const SelfOptions& options);

  [[nodiscard]] std::unique_ptr<map::FaceSearch> search() const override;
  [[nodiscard]] bool counts_at_vertices(std::uint32_t face) const override;

 private:
  const sites::SitesData& sites_;
  const Exclusion& exclusion_;
  double max_distance_;
  PatchTree patches_;
};

}  // namespace sdm::self
