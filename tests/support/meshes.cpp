#include "support/meshes.h"

#include <sdm/mesh_files.h>

#include "io/mesh/placement.h"

namespace sdm::test {

std::string mesh_file(const std::string& name) {
  return SDM_TEST_MESHES "/" + name;
}

Mesh load(const std::string& name, std::string_view steps) {
  return placed(read_mesh(mesh_file(name)), steps);
}

Mesh placed(Mesh mesh, std::string_view steps) {
  io::place(mesh, io::parse_placement(steps));
  return mesh;
}

std::vector<Vec3> placed(const std::vector<Vec3>& points, std::string_view steps) {
  return placed(Mesh{.positions = points, .triangles = {{0, 1, 2}}, .corner_uvs = {}}, steps).positions;
}

}  // namespace sdm::test
