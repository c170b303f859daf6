// Values of O2 at the points that belong to the texels of a surface.
#pragma once

#include <sdm/transfer.h>

#include "module/arguments.h"
#include "module/result.h"

namespace sdm::js {

/// The values of `count` numbers, a row for each texel. `source`: a DistanceMap or TexelMatches.
template <typename Source>
Result* transferred(const Surface* surface, const Sites* sites, const Source* source, const float* values,
                    std::uint32_t count, std::uint32_t components, std::uint32_t domain, bool fill) {
  return guarded([&](Result& result) {
    result.add(transfer(
        *surface, *sites, *source,
        {.values = {values, count}, .components = components, .domain = static_cast<AttributeDomain>(domain)},
        {.fill = fill, .progress = host_progress()}));
  });
}

}  // namespace sdm::js
