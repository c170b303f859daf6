// Inside or outside of a mesh. All such tests go through this header: InsideTest for queries whose closest
// points are known, and contains(), which is exact, for a moved solid. SitesData::is_solid determines which
// meshes have an inside.
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
  /// A bit mask of the queries of a packet that are inside.
  [[nodiscard]] std::uint32_t operator()(std::span<const Vec3> queries,
                                         const sites::ClosestPacket& closest) const;

 private:
  /// Whether a face around the site is too thin for a reliable normal; a ray decides there.
  [[nodiscard]] bool beside_sliver(const ClosestPoint& c) const;

  const sites::SitesData& sites_;
  SignMethod method_;
  Box box_;  ///< of O2: no point outside it is inside O2, even where rounding would decide
  bool has_slivers_ = false;
  std::optional<WindingNumber> winding_;
};

}  // namespace sdm::inside
