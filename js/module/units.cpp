// Whether a mesh is in another unit of length than sites.
#include <sdm/doubts.h>

#include "module/arguments.h"
#include "module/result.h"

namespace sdm::js {

/// Nothing if the mesh fits in no other unit.
SDM_EXPORT(sdm_unit_check)
Result* unit_check(const double* positions, std::uint32_t vertices, const std::uint32_t* indices,
                   std::uint32_t triangles, const Sites* sites) {
  return guarded([&](Result& result) {
    const auto unit = find_other_unit_in_place(mesh(positions, vertices, indices, triangles), sites->mesh());
    if (!unit) return;
    result.put("unit/factor", unit->factor);
    result.put("unit/misfit", unit->misfit);
    result.put("unit/misfit_as_given", unit->misfit_as_given);
    result.put("unit/same_box", unit->same_box);
    result.put("unit/text", doubt_of(*unit).text);
  });
}

}  // namespace sdm::js
