// Inside or outside of O2.
#pragma once

#include <sdm/map.h>

#include <optional>

#include "engine/winding.h"
#include "mesh/sites_impl.h"

namespace sdm {

/// Tells whether queries lie inside, by one method, for many of them.
class InsideTest {
 public:
  /// `method` as chosen by choose_sign; `none` makes every answer "outside".
  InsideTest(const Sites::Impl& sites, SignMethod method);

  /// `closest` is the closest point of the query (not used by the winding number). On the surface: outside.
  [[nodiscard]] bool operator()(const Vec3& query, const ClosestPoint& closest) const;

 private:
  const Sites::Impl& sites_;
  SignMethod method_;
  std::optional<WindingNumber> winding_;
};

}  // namespace sdm
