// An axis that separates two surfaces.
#pragma once

#include "bodies/pairs/mesh_pair.h"

namespace sdm::pairs {

/// Whether some axis separates the boxes around the surfaces, or those around the children of the roots of
/// their trees. If so the surfaces have no point in common. Cost: far less than that of a search.
[[nodiscard]] bool have_separating_axis(const MeshPair& pair);

}  // namespace sdm::pairs
