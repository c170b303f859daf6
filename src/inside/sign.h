// The sign method of a shape, and the data that all inside tests of it share.
#pragma once

#include <cstdint>
#include <string>

#include "core/lazy/kept.h"
#include "inside/face_sides.h"
#include "inside/open_sides.h"
#include "inside/winding_number.h"
#include "sites/sites_data.h"

namespace sdm::inside {

/// The data of all inside tests of a shape, kept with its sites until they change. Each sign method has a
/// part that is made on first use: for a solid, a byte for each face; for winding numbers of an open mesh,
/// the closing faces with their tree and a byte for each face, and where they do not decide, 64 bytes for
/// each child of a node of the wide tree over its faces, and 36 for each face; for sides, a byte for each
/// edge and vertex.
struct ShapeSigns {
  explicit ShapeSigns(const sites::SitesData& sites);
  /// Starts anew, for the same faces at other positions. Reuses the memory for solids.
  void renew();

  Box box;               ///< of O2: no point outside it is inside O2, even where rounding would decide
  double clearance;      ///< kClearance in units of the mesh
  std::uint64_t number;  ///< unique, over all objects
  std::string why_open;  ///< the reason why O2 has no inside, as a clause; empty if it has one

  [[nodiscard]] const FaceSides& sides() const;
  [[nodiscard]] const WindingNumber& winding() const;
  [[nodiscard]] const BoundarySites& boundary() const;

 private:
  const sites::SitesData& sites_;
  Kept<FaceSides> sides_;
  Kept<WindingNumber> winding_;
  Kept<BoundarySites> boundary_;
};

/// The ShapeSigns of the present shape, made by the first call. Thread-safe.
[[nodiscard]] const ShapeSigns& signs_of(const sites::SitesData& sites);

}  // namespace sdm::inside
