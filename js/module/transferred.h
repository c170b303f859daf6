// Values of O2 at the points that belong to the texels of a surface.
#pragma once

#include <sdm/match.h>

#include "module/arguments.h"
#include "module/options.h"
#include "module/result.h"

namespace sdm::js {

/// The values of rows of O2, a row for each texel. `source`: a DistanceMap or TexelMatches.
template <typename Source>
Result* transferred(const Surface* surface, const Sites* sites, const Source* source,
                    std::span<const float> values, const GivenOptions& given) {
  return guarded([&](Result& result) {
    auto [array, options] = read_all_options<AttributeArray, TransferOptions>(given);
    array.values = values;
    options.progress = host_progress();
    result.put("values", transfer(*surface, *sites, *source, array, options));
  });
}

}  // namespace sdm::js
