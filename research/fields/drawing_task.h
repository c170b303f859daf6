// What the methods of the literature compute a field from.
#pragma once

#include "inside/inside.h"
#include "research/fields/fields.h"
#include "sites/sites_data.h"

namespace sdm::fields {

struct DrawingTask {
  const sites::SitesData& sites;  ///< of O2
  const Grid& grid;
  const Options& options;
  const inside::InsideTest& is_inside;
  bool is_signed;
};

}  // namespace sdm::fields
