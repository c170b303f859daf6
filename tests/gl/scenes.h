// Pairs of meshes for the gl engine: all kinds that are difficult for a rasteriser of regions.
#pragma once

#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <functional>
#include <string_view>
#include <vector>

namespace sdm::test {

struct Scene {
  const char* name;
  std::function<Mesh()> o1, o2;
  AtlasOptions atlas{.resolution = 256};
  bool both_signs = false;  ///< O2 is closed, and O1 has texels on either side of it
};

[[nodiscard]] const std::vector<Scene>& scenes();
[[nodiscard]] const Scene& scene(std::string_view name);
[[nodiscard]] std::string scene_name(const testing::TestParamInfo<Scene>& info);
void PrintTo(const Scene& scene, std::ostream* out);

}  // namespace sdm::test
