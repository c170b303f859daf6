/// The engines that find closest sites.
#pragma once

namespace sdm {

enum class EngineKind {
  cpu,        ///< lists of sites for groups of texels, SIMD, all cores
  reference,  ///< scalar, double, plain: the oracle
  gl,         ///< the paper's: polygons of sites rasterised by OpenGL; maps only
};

}  // namespace sdm
