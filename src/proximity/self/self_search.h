// The nearest of those faces of a mesh that one of its faces does not exclude.
#pragma once

#include <sdm/self_proximity_query.h>

#include <vector>

#include "sites/sites_data.h"

namespace sdm::self {

/// The closest points of two faces.
struct FacePair {
  double distance = std::numeric_limits<double>::infinity();
  std::uint32_t face1 = kNone, face2 = kNone;  ///< the smaller first; kNone: there are none
  Vec3 point1{}, point2{};

  /// The nearer one; of equals, that of the smaller faces: one of any set of pairs is before all others.
  [[nodiscard]] bool before(const FacePair& other) const;
};

/// Searches of one thread, each from a face; its memory is kept from one to the next, also when they are made
/// anew.
class SelfSearch {
 public:
  /// The arguments must outlive it. One at a time in a thread.
  SelfSearch(const sites::SitesData& sites, const Exclusion& exclusion);
  ~SelfSearch();
  SelfSearch(const SelfSearch&) = delete;
  SelfSearch& operator=(const SelfSearch&) = delete;

  /// From now on it is this face whose neighbourhood is passed over.
  void start_from(std::uint32_t face);

  /// Gathers the faces that can be the closest one of any point in a ball.
  void gather(const Vec3& centre, double radius, double max_distance);
  /// The closest point to a point of that ball, within the same distance.
  [[nodiscard]] ClosestPoint closest_to(const Vec3& q) const;

  /// The nearest face to the one it started from, within max_distance.
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
