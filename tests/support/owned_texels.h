// The samples that are texels, for what has values at these only.
#pragma once

#include <sdm/surface.h>

#include <cstdint>
#include <vector>

namespace sdm::test {

[[nodiscard]] inline std::vector<std::uint32_t> owned_texels(const Surface& surface) {
  std::vector<std::uint32_t> texels;
  for (const std::uint32_t sample : surface.sample_texels())
    if (sample < surface.texel_faces().size()) texels.push_back(sample);
  return texels;
}

}  // namespace sdm::test
