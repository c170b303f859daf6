#include <sdm/error.h>
#include <sdm/self_intersections.h>
#include <sdm/solid.h>

#include <new>

#include "core/memory.h"
#include "geometry/vec.h"
#include "inside/solid_boundary.h"

namespace sdm {

namespace {

void check_solid(const Sites& sites) {
  if (!internals(sites).is_solid()) throw Error("a mesh that is not closed and orientable has no volume");
}

}  // namespace

BoundedNumber solid_volume(const Sites& sites, const SolidVolumeOptions& options) try {
  check_solid(sites);
  const sites::SitesData& data = internals(sites);
  if (!(options.embedded ? *options.embedded : is_embedded(sites))) {
    const inside::SolidBoundary::Volume bounds =
        inside::SolidBoundary(data, inside::FaceSides(data)).volume();
    const bool exact = bounds.lower == bounds.upper;
    return {.value = exact ? bounds.lower : 0.5 * (bounds.lower + bounds.upper),
            .certainty = exact ? Certainty::exact : Certainty::bounded,
            .lower = bounds.lower,
            .upper = bounds.upper};
  }
  // The divergence theorem: tetrahedra between the faces and a point near them.
  double six_volumes = 0;
  for (const std::uint32_t face : data.tree.items) {
    const Triangle& t = data.mesh.triangles[face];
    const auto from_origin = [&](int k) { return data.mesh.positions[t[k]] - data.frame.origin; };
    const double six_volume = dot(from_origin(0), cross(from_origin(1), from_origin(2)));
    six_volumes += data.inverted[face] ? -six_volume : six_volume;
  }
  const double volume = six_volumes / 6;
  return {.value = volume, .certainty = Certainty::exact, .lower = volume, .upper = volume};
} catch (const std::bad_alloc&) {
  throw out_of_memory("the volume of a solid");
}

}  // namespace sdm
