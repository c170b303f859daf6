// The distances that bounds on a depth are made from.
#include <gtest/gtest.h>
#include <sdm/sdm.h>

#include <random>

#include "certify/depth/face_distances.h"
#include "sites/closest_on_face.h"
#include "support/shapes.h"

namespace sdm::depth {
namespace {

// Also of slivers, segments and points, in all regions around them.
TEST(FaceDistances, AreThoseOfClosestOnFace) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (const Mesh& mesh :
       {test::soup(60, random), test::degenerate_soup(60, 6), test::needles(1e-9), test::cube()}) {
    const Sites o2(mesh);
    const sites::SitesData& sites = internals(o2);
    for (int trial = 0; trial < 500; ++trial) {
      const auto face = [&] { return static_cast<std::uint32_t>(random() % mesh.triangles.size()); };
      const std::array faces{face(), face()};
      std::array<Vec3, 4> points;
      for (Vec3& p : points) p = {normal(random), normal(random), normal(random)};
      points[3] = mesh.positions[mesh.triangles[faces[0]][1]];
      const auto distances = face_distances(sites, points, faces);
      for (int f = 0; f < 2; ++f)
        for (int i = 0; i < 4; ++i)
          EXPECT_NEAR(distances[f][i], sites::closest_on_face(sites, faces[f], points[i]).distance, 1e-12);
    }
  }
}

}  // namespace
}  // namespace sdm::depth
