#include "scenes.h"

#include <sdm/io.h>
#include <sdm/transform.h>

#include <string>

#include "reduce_mesh.h"

namespace sdm::bench {

Mesh load(std::string_view name, std::string_view steps) {
  Mesh mesh = read_mesh(std::string(SDM_BENCH_MESHES) + "/" + std::string(name));
  transform(mesh, parse_transform(steps));
  return mesh;
}

Mesh paper_figure() {
  return reduce_mesh(load("man.off", "fit"), 17200);
}

Mesh paper_box(const Mesh& figure) {
  constexpr double margin = 0.12;
  const Box box = bounds(figure);
  Mesh result;
  // Corner 4z + 2y + x lies at the high end of the axes whose bit is set.
  for (int corner = 0; corner < 8; ++corner) {
    Vec3& p = result.positions.emplace_back();
    for (int k = 0; k < 3; ++k) p[k] = (corner >> k & 1) != 0 ? box.hi[k] + margin : box.lo[k] - margin;
  }
  result.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return result;
}

}  // namespace sdm::bench
