// Candidates of a few points, compared in double precision. Included once for each set of vector
// instructions.
#if defined(SDM_CANDIDATES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SDM_CANDIDATES_INL_H
#undef SDM_CANDIDATES_INL_H
#else
#define SDM_CANDIDATES_INL_H
#endif

#include <span>
#include <tuple>
#include <utility>

#include "closest/single_point.h"
#include "geometry/lanes/closest_feature-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sdm::closest::HWY_NAMESPACE {
namespace {

// The closest of the candidates of each point, as closest_on_face() has them.
class Settled {
 public:
  static constexpr size_t kMost = SinglePointMemory::kPacket;

  explicit Settled(const sites::SitesData& sites) : sites_(sites) {}

  // Which of several candidates at the same distance is taken: the first that is offered, and tied() is set;
  // or the first by type, site and face, which does not depend on the order of the search.
  enum class Equal { in_order, by_name };

  // Compares the candidates that are within the limits of their points.
  void compare(std::span<const Vec3> queries, const float* limit,
               std::span<const SinglePointMemory::Candidate> candidates, Equal equal) {
    for (size_t i = 0; i < queries.size(); ++i) best_[i].distance = kInfinity;
    tied_ = 0;
    equal_ = equal;
    size_t count = 0;
    for (const SinglePointMemory::Candidate& candidate : candidates) {
      if (!(candidate.bound <= limit[candidate.point])) continue;
      const auto [a, b, c] = corners_of(sites_.mesh, candidate.face);
      features_.set(count, queries[candidate.point], a, b, c, sites_.sliver[candidate.face] == 0);
      chosen_[count++] = &candidate;
      if (count < kLanes) continue;
      take(kLanes);
      count = 0;
    }
    if (count == 0) return;
    const SinglePointMemory::Candidate& last = *chosen_[count - 1];
    const auto [a, b, c] = corners_of(sites_.mesh, last.face);
    for (size_t lane = count; lane < kLanes; ++lane) features_.set(lane, queries[last.point], a, b, c, true);
    take(count);
  }

  // The bits of points that have different results at the same distance in different leaves.
  [[nodiscard]] uint32_t tied() const { return tied_; }

  [[nodiscard]] ClosestPoint closest(size_t point, double max_distance) const {
    const Best& best = best_[point];
    if (!(best.distance <= max_distance) || best.distance == kInfinity) return {};
    const auto [type, site] = site_of(best);
    return {.point = best.point, .distance = best.distance, .site = site, .type = type, .face = best.face};
  }

 private:
  using Features = lanes::HWY_NAMESPACE::ClosestFeatures;
  static constexpr size_t kLanes = lanes::HWY_NAMESPACE::kLanes;

  struct Best {
    double distance;
    Vec3 point;
    uint32_t face, leaf;
    int feature;
  };

  [[nodiscard]] std::pair<SiteType, uint32_t> site_of(const Best& best) const {
    if (best.feature == Features::kInterior) return {SiteType::face, best.face};
    if (best.feature < Features::kSides)
      return {SiteType::vertex, sites_.mesh.triangles[best.face][static_cast<size_t>(best.feature)]};
    return {SiteType::edge,
            sites_.topology.face_edges[best.face][static_cast<size_t>(best.feature - Features::kSides)]};
  }

  [[nodiscard]] std::tuple<SiteType, uint32_t, uint32_t> name_of(const Best& best) const {
    return std::tuple_cat(site_of(best), std::tuple(best.face));
  }

  void take(size_t count) {
    features_.compute(count);
    for (size_t lane = 0; lane < count; ++lane) {
      const SinglePointMemory::Candidate& from = *chosen_[lane];
      Best& best = best_[from.point];
      if (!(features_.distance[lane] <= best.distance)) continue;
      const Best here{features_.distance[lane],
                      {features_.point[0][lane], features_.point[1][lane], features_.point[2][lane]},
                      from.face,
                      from.leaf,
                      static_cast<int>(features_.feature[lane])};
      const uint32_t bit = 1u << from.point;
      if (here.distance < best.distance) {
        best = here;
        tied_ &= ~bit;
      } else if (equal_ == Equal::by_name)
        best = name_of(here) < name_of(best) ? here : best;
      else if (here.leaf != best.leaf && (here.point != best.point || site_of(here) != site_of(best)))
        tied_ |= bit;
    }
  }

  const sites::SitesData& sites_;
  Features features_;
  const SinglePointMemory::Candidate* chosen_[kLanes];
  Best best_[kMost];
  uint32_t tied_ = 0;
  Equal equal_ = Equal::in_order;
};

}  // namespace
}  // namespace sdm::closest::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
