#include "poses.h"

#include <cmath>

#include "bodies/pairs/pair_search.h"
#include "geometry/vec.h"

namespace sdm::bench {

Affine random_rotation(std::mt19937& random) {
  // A unit quaternion, uniform on the four-dimensional unit sphere.
  std::normal_distribution<double> normal;
  double q[4], squared = 0;
  for (double& x : q) {
    x = normal(random);
    squared += x * x;
  }
  for (double& x : q) x /= std::sqrt(squared);
  const auto& [w, x, y, z] = q;
  return {{{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
            {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
            {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}},
          {}};
}

std::vector<Affine> random_poses(const Sites& o1, const Sites& o2, std::size_t count, std::mt19937& random) {
  const Box box1 = bounds(o1.mesh()), box2 = bounds(o2.mesh());
  const double size = 0.5 * (diagonal(box1) + diagonal(box2));
  pairs::PairWorkspace workspace;
  std::vector<Affine> poses;
  while (poses.size() < count) {
    pairs::MeshPair pair{internals(o1), internals(o2), random_rotation(random)};
    const Vec3 away = random_rotation(random).rows[0];
    const Vec3 centred = centre(box1) - pair.pose(centre(box2));
    const auto place = [&](double distance) { pair.pose.offset = centred + distance * away; };
    const Stand stand = kStands[poses.size() % std::size(kStands)];
    double at = 2 * size;
    place(at);
    // Move closer by the separation, which cannot make the surfaces intersect, until they touch.
    for (int step = 0; step < 60 && stand != Stand::deep; ++step) {
      const double free = pairs::find_closest(pair, 4 * size, workspace).distance;
      if (free < 1e-15 * size) break;
      place(at - free);
      if (pairs::find_intersection(pair, workspace).intersecting) break;
      at -= free;
    }
    at += stand == Stand::far ? 0.5 * size : stand == Stand::near ? 0.01 * size : 0;
    at -= stand == Stand::penetrating ? 0.05 * size : stand == Stand::deep ? at : 0;
    place(at);
    poses.push_back(pair.pose);
  }
  return poses;
}

}  // namespace sdm::bench
