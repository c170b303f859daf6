#include "proximity/shape/posed_body.h"

#include <sdm/error.h>

#include "mesh/validate.h"

namespace sdm::shape {

void PosedBody::require_own_shape() const {
  if (internals(shape_).use_count() > 1)
    throw Error(
        "its shape is shared and cannot be deformed; give a body that deforms a Shape of its own, and keep "
        "no copy");
}

void PosedBody::check_refit(std::span<const Vec3> positions) const {
  require_own_shape();
  mesh::validate_positions(positions, body().sites().mesh().positions.size());
}

}  // namespace sdm::shape
