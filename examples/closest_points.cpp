// Distances from points to a mesh and the closest features, without file input or output.
#include <sdm/sdm.h>

#include <cstdio>

int main() {
  const sdm::Sites tetrahedron(sdm::Mesh{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                         .triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}},
                                         .corner_uvs = {}});
  const std::vector<sdm::Vec3> points{{2, 0, 0}, {0.5, 0.5, -1}, {1, 1, 1}};
  for (const sdm::ClosestPoint& c : sdm::closest_points(tetrahedron, points)) {
    const char* names[] = {"vertex", "edge", "face"};
    std::printf("%.4f to %s %u\n", c.distance, names[static_cast<int>(c.type)], c.site);
  }
}
