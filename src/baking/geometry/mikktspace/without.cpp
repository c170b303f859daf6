#include <sdm/error.h>

#include "baking/geometry/mikktspace/frames.h"

namespace sdm::baking {

bool has_mikktspace() {
  return false;
}

void set_tangents(std::span<std::array<MikkCorner, 3>> /*triangles*/) {
  throw Error(
      "this build of sdm has no tangents: build it with -DSDM_TANGENTS=ON, which downloads MikkTSpace");
}

}  // namespace sdm::baking
