// The sites of O2 as the slice methods draw them.
#pragma once

#include <vector>

#include "gl/polygons/convex_polygon.h"
#include "gl/polygons/site_region.h"
#include "research/fields/drawing_task.h"
#include "research/site_code.h"
#include "volume/grid.h"

namespace sdm::fields {

using volume::UnitGrid;

using gl::HalfPlane;
using gl::HalfSpace;
using gl::SiteRegion;
using research::site_code;
using research::site_of;

struct DrawnSite {
  SiteRegion region;
  Box box;             ///< of the site, in the unit frame
  std::uint32_t code;  ///< site_code
};

/// The sites whose region of influence has an interior, in the order of O2's tree. Throws sdm::Error if there
/// is not enough memory. Cost: linear, all cores.
[[nodiscard]] std::vector<DrawnSite> drawn_sites(const sites::SitesData& sites);

/// What depends on the extent of the scene in the unit frame.
struct SliceRules {
  double slack;   ///< walls are moved outwards by this, so that rounding opens no cracks
  double margin;  ///< distances that differ by less may compare either way
  double limit;   ///< no larger distance is needed: the band, or more than any distance

  /// Throws sdm::Error if the grid is too far from O2 for single precision.
  SliceRules(const DrawingTask& task, const UnitGrid& grid);
};

}  // namespace sdm::fields
