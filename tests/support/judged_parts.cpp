#include "support/judged_parts.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/meshes.h"
#include "support/oracle.h"
#include "support/shapes.h"

namespace sdm::test {

std::vector<std::pair<std::string, Mesh>> judged_parts() {
  std::vector<std::pair<std::string, Mesh>> result;
  for (const char* name : {"fandisk.off", "cow.off", "elephant.off", "anchor.off", "pinion.off", "rotor.off",
                           "joint.off", "couplingdown.off", "dragknob.off", "spool.off", "pipe.off",
                           "knot1.off", "bones.off", "star.off", "cross.off", "beam.off"})
    result.emplace_back(name, load(name, "fit"));
  result.emplace_back("ring", ring(32, 0.5));
  result.emplace_back("cube", cube(0.5));
  result.emplace_back("sphere", placed(sphere(3), "scale:0.5"));
  result.emplace_back("two cubes", joined(cube(0.3), moved(cube(0.2), {0.8, 0, 0})));
  return result;
}

Mesh remeshed(const Mesh& mesh) {
  Mesh result;
  result.positions = mesh.positions;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto middle = [&](std::uint32_t i, std::uint32_t j) {
      result.positions.push_back(0.5 * (mesh.positions[std::min(i, j)] + mesh.positions[std::max(i, j)]));
      return static_cast<std::uint32_t>(result.positions.size() - 1);
    };
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    for (const Triangle& t :
         {Triangle{a, ab, ca}, Triangle{ab, b, bc}, Triangle{ca, bc, c}, Triangle{ab, bc, ca}})
      result.triangles.push_back(t);
  }
  return result;
}

Mesh with_defect(const Mesh& part, double limit) {
  const oracle::CgalDistance distance(part);
  std::vector<Vec3> normals(part.positions.size());
  for (const Triangle& t : part.triangles) {
    const Vec3 n =
        cross(part.positions[t[1]] - part.positions[t[0]], part.positions[t[2]] - part.positions[t[0]]);
    for (const std::uint32_t v : t) normals[v] += n;
  }
  for (std::size_t v = 0; v < normals.size(); ++v)
    for (const double times : {1.25, -1.25, 2.0}) {
      const Vec3 moved = part.positions[v] + times * limit * normalized(normals[v]);
      if (const double d = distance(moved); d < 1.2 * limit || d > 1.6 * limit) continue;
      Mesh defect = part;
      defect.positions[v] = moved;
      return defect;
    }
  ADD_FAILURE() << "no vertex can be moved away";
  return part;
}

}  // namespace sdm::test
