// Rays against sites, and from the texels of a map.
#pragma once

#include "map.h"
#include "objects.h"

namespace sdm::python {

/// RayHits, and the methods of Sites that take rays.
void bind_rays(nb::module_& module, nb::class_<PySites>& sites);
void bind_map_rays(nb::class_<PyMap>& map);

}  // namespace sdm::python
