// Pairs of meshes whose poses are compared with other implementations.
#pragma once

#include <gtest/gtest.h>
#include <sdm/mesh.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <ostream>
#include <string>

#include "bodies/pairs/mesh_pair.h"
#include "support/meshes.h"
#include "support/oracle.h"
#include "support/shapes.h"

namespace sdm::test {

struct PosedPair {
  const char *o1, *o2;
};
inline void PrintTo(const PosedPair& pair, std::ostream* out) {
  *out << pair.o1 << " and " << pair.o2;
}

// The last are generated: a ball, and a ball flattened to a disc of slivers.
inline constexpr PosedPair kPosedPairs[] = {
    {"hand.off", "head.off"},          {"elephant.off", "triceratops.off"},
    {"knot2.off", "anchor_dense.off"}, {"cube-meshed.off", "sphere966.off"},
    {"bunny.obj", "armadillo.off"},    {"ball", "disc"}};

inline std::string name_of_pair(const testing::TestParamInfo<PosedPair>& pair) {
  std::string text = testing::PrintToString(pair.param);
  std::ranges::replace_if(
      text, [](unsigned char c) { return !std::isalnum(c); }, '_');
  return text;
}

inline Mesh mesh_of(const std::string& name) {
  if (name.find('.') != std::string::npos) return load(name, "fit");
  Mesh mesh = sphere(3);
  if (name == "disc")
    for (Vec3& p : mesh.positions) p[2] *= 1e-5;
  return mesh;
}

inline bool cgal_says_intersect(const oracle::CgalSurface& o1, const pairs::MeshPair& pair) {
  for (std::uint32_t face = 0; face < pair.o2.mesh.triangles.size(); ++face)
    if (o1.meets(pair.face2(face))) return true;
  return false;
}

}  // namespace sdm::test
