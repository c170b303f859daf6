// Finds the nearest face of a mesh that a given face does not exclude.
#pragma once

#include <sdm/self_proximity_query.h>

#include <vector>

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

/// Per-thread searches, each starting from a face. The memory is kept between searches and between objects.
class SelfSearch {
 public:
  /// The arguments must outlive it. At most one per thread at a time.
  SelfSearch(const sites::SitesData& sites, const Exclusion& exclusion);
  ~SelfSearch();
  SelfSearch(const SelfSearch&) = delete;
  SelfSearch& operator=(const SelfSearch&) = delete;

  /// Sets the face whose neighbourhood is excluded.
  void start_from(std::uint32_t face);

  /// Collects the faces that can be closest to any point of a ball.
  void gather(const Vec3& centre, double radius, double max_distance);
  /// The closest point to a point of that ball, within the same distance.
  [[nodiscard]] ClosestPoint closest_to(const Vec3& q) const;

  /// The nearest face to the face of start_from(), within max_distance.
  [[nodiscard]] FacePair nearest(double max_distance) const;

 private:
  struct Scratch;
  template <class Visit>
  void visit_near(const Box& box, double& limit, const Visit& visit) const;

  const sites::SitesData& sites_;
  const Exclusion& exclusion_;
  Scratch& scratch_;
  std::uint32_t face_ = kNone;
  Vec3 centre_{};
  double max_distance_ = 0;
};

}  // namespace sdm::self
