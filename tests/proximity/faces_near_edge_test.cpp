// The faces near an edge, and those that may support it, against tests of each face in double precision.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <array>
#include <random>
#include <set>
#include <vector>

#include "bodies/contacts/faces_near_edge.h"
#include "bodies/contacts/support.h"
#include "geometry/triangle_pair.h"
#include "geometry/vec.h"
#include "support/meshes.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

using contacts::FacesNearEdge;

class FacesNearEdgeTest : public testing::Test {
 protected:
  Vec3 vector() { return {normal_(random_), normal_(random_), normal_(random_)}; }
  double uniform() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  std::uint32_t face_of(const sites::SitesData& sites) {
    return static_cast<std::uint32_t>(random_() % sites.mesh.triangles.size());
  }
  static Corners corners_of(const sites::SitesData& sites, std::uint32_t face) {
    const auto& [a, b, c] = sites.mesh.triangles[face];
    return {sites.mesh.positions[a], sites.mesh.positions[b], sites.mesh.positions[c]};
  }
  // Faces that repeat another one are not in the tree.
  static std::vector<bool> faces_in_tree(const sites::SitesData& sites) {
    std::vector<bool> in_tree(sites.mesh.triangles.size());
    for (const std::uint32_t face : sites.tree.items) in_tree[face] = true;
    return in_tree;
  }
  static std::set<std::uint32_t> set_of(std::span<const std::uint32_t> faces) {
    return {faces.begin(), faces.end()};
  }

  std::vector<Mesh> meshes_{cube(0.5), placed(torus(32, 16), "fit"), load("cow.off", "fit"),
                            degenerate_soup(300, 4), moved(placed(torus(32, 16), "fit"), {100, 20, -40})};
  FacesNearEdge faces_;
  std::mt19937 random_{3};
  std::normal_distribution<double> normal_;
};

TEST_F(FacesNearEdgeTest, ContainAllWithinReach) {
  std::size_t near = 0, found = 0, all = 0;
  for (const Mesh& mesh : meshes_) {
    const Sites built(mesh);
    const sites::SitesData& sites = internals(built);
    const double size = diagonal(bounds(mesh));
    const std::vector<bool> in_tree = faces_in_tree(sites);
    for (int trial = 0; trial < 100; ++trial) {
      const Vec3 corner = corners_of(sites, face_of(sites))[0];
      Vec3 a = corner + 0.02 * size * vector(), along = 0.3 * size * vector();
      switch (trial % 10) {
        case 0:
          along = {};
          break;
        case 1:
          along[0] = along[2] = 0;
          break;
        case 2:
          along = 1e5 * along;
          [[fallthrough]];
        default:
          a = corner - uniform() * along;  // through a vertex
        case 3:
        case 4:
          break;
      }
      const double reach = trial % 2 == 0 ? 1e-9 * size : 0.05 * size * uniform();
      const std::set<std::uint32_t> candidates = set_of(faces_.find(sites, {a, a + along}, reach));
      for (std::uint32_t face = 0; face < mesh.triangles.size(); ++face) {
        const PointPair closest = closest_or_common({a, a + along, a + along}, corners_of(sites, face));
        if (closest.squared > reach * reach || !in_tree[face]) continue;
        ++near;
        EXPECT_TRUE(candidates.contains(face))
            << face << " of " << mesh.triangles.size() << ", trial " << trial;
      }
      found += candidates.size();
      all += mesh.triangles.size();
    }
  }
  EXPECT_GT(near, 1000u);
  EXPECT_LT(found, all / 20);  // most faces are excluded
}

TEST_F(FacesNearEdgeTest, ContainAllThatSupportIt) {
  std::size_t supporting = 0, found = 0, all = 0;
  for (const Mesh& mesh : meshes_) {
    const Sites built(mesh);
    const sites::SitesData& sites = internals(built);
    const double size = diagonal(bounds(mesh));
    const std::vector<bool> in_tree = faces_in_tree(sites);
    for (int trial = 0; trial < 400; ++trial) {
      // An edge near a face and nearly parallel to it, between faces that mostly face away from it.
      const std::uint32_t below = face_of(sites);
      const Corners corners = corners_of(sites, below);
      const Vec3 normal = sites.normals.face[below];
      const double margin = trial % 2 == 0 ? 0 : 0.02 * size * uniform(), reach = 0.15 * size * uniform();
      Vec3 across = vector();
      across = across - dot(across, normal) * normal;
      const Vec3 along = size * (0.2 * normalized(across) + 0.02 * uniform() * normal);
      const Vec3 middle = (1.0 / 3) * (corners[0] + corners[1] + corners[2]);
      const Vec3 a = middle - uniform() * along + (margin - (margin + reach) * uniform()) * normal;
      std::vector<Vec3> sides;
      for (int i = 0; i < trial % 4; ++i) sides.push_back(vector() + 1.5 * normal);
      const std::set<std::uint32_t> candidates =
          set_of(faces_.find_supporting(sites, {a, a + along}, sides, margin, reach));
      const std::array<Vec3, 2> both{along, -along};
      for (std::uint32_t face = 0; face < mesh.triangles.size(); ++face) {
        const Vec3& n = sites.normals.face[face];
        if (!in_tree[face] || sites.sliver[face] != 0 || !contacts::can_push(n, both) ||
            !contacts::can_push(n, sides))
          continue;
        const contacts::Clip clip = contacts::clip_to_prism(sites, face, a, along, margin, reach);
        if (!(clip.from < clip.to)) continue;
        ++supporting;
        EXPECT_TRUE(candidates.contains(face))
            << face << " of " << mesh.triangles.size() << ", trial " << trial;
      }
      found += candidates.size();
      all += mesh.triangles.size();
    }
  }
  EXPECT_GT(supporting, 1000u);
  EXPECT_LT(found, all / 20);
}

}  // namespace
}  // namespace sdm::test
