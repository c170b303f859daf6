#include "engine/gl/gl_engine.h"

#include <sdm/error.h>

namespace sdm {

std::vector<std::uint32_t> gl_winners(const Surface&, const Sites&, const MapOptions&, RasterReport&) {
  throw Error("not yet");
}

}  // namespace sdm
