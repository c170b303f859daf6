#include "closest/exact.h"

namespace sdm::closest {

ClosestPoint exact_closest(const sites::SitesData& sites, const Vec3& q, double max_distance) {
  const auto all = [](std::uint32_t) { return true; };
  return exact_closest(sites, q, max_distance, all, all);
}

}  // namespace sdm::closest
