// Inside or outside of a mesh. All such questions go through this header: on which side queries lie whose
// closest points are known (InsideTest), and whether a moved solid contains a point, exactly (contains).
// Which meshes have an inside is up to SitesData::is_solid.
#pragma once

#include <sdm/sign.h>

#include <optional>
#include <span>

#include "inside/solid.h"
#include "inside/winding_number.h"
#include "sites/closest_packet.h"
#include "sites/sites_data.h"

namespace sdm::inside {

/// Tests whether points lie inside O2, by one method, for many queries.
class InsideTest {
 public:
  /// `method` as chosen by choose_sign; `none` makes every answer "outside".
  InsideTest(const sites::SitesData& sites, SignMethod method);

  /// `closest` is the closest point of the query (not used by the winding number). On the surface: outside.
  [[nodiscard]] bool operator()(const Vec3& query, const ClosestPoint& closest) const;
  /// A bit for each query of a packet that is inside.
  [[nodiscard]] std::uint32_t operator()(std::span<const Vec3> queries,
                                         const sites::ClosestPacket& closest) const;

 private:
  /// Whether a face around the site is too thin for a reliable normal; a ray decides there.
  [[nodiscard]] bool beside_sliver(const ClosestPoint& c) const;

  const sites::SitesData& sites_;
  SignMethod method_;
  Box box_;  ///< of O2: no point outside it is inside O2, however close the tie
  bool has_slivers_ = false;
  std::optional<WindingNumber> winding_;
};

}  // namespace sdm::inside
