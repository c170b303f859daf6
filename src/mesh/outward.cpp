#include "mesh/outward.h"

#include "core/parallel.h"
#include "core/vec.h"
#include "mesh/ray_parity.h"

namespace sdm {
namespace {

struct Shell {
  std::uint32_t component;
  std::vector<std::uint32_t> faces;
  bool inward = false;  ///< as turned by the orientation, the faces enclose a negative volume
};

// Six times the volume; a corner of the shell as origin keeps the digits of small shells.
double volume(const Shell& shell, std::span<const Vec3> p, std::span<const Triangle> triangles,
              std::span<const std::uint8_t> turned) {
  const Vec3& origin = p[triangles[shell.faces.front()][0]];
  double sum = 0;
  for (std::uint32_t f : shell.faces) {
    const Triangle& t = triangles[f];
    const double v = dot(p[t[0]] - origin, cross(p[t[1]] - origin, p[t[2]] - origin));
    sum += turned[f] ? -v : v;
  }
  return sum;
}

// Whether the shell lies inside an odd number of others. Shells that touch or overlap others lie partly
// inside at most: a few points just outside faces far apart must all agree.
bool hollow(const Shell& shell, std::span<const Vec3> p, std::span<const Triangle> triangles,
            const Orientation& orientation, const AabbTree& tree) {
  constexpr std::size_t kPoints = 5;
  constexpr double kOff = 1e-7;  // in the unit frame
  for (std::size_t i = 0; i < kPoints; ++i) {
    const std::uint32_t f = shell.faces[i * shell.faces.size() / kPoints];
    const Triangle& t = triangles[f];
    const Vec3 normal = normalized(cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]));
    const bool inward = shell.inward != static_cast<bool>(orientation.turned[f]);
    const Vec3 point = (1.0 / 3) * (p[t[0]] + p[t[1]] + p[t[2]]) + (inward ? -kOff : kOff) * normal;
    if (!odd_crossings(p, triangles, tree, point, orientation.component, shell.component)) return false;
  }
  return true;
}

}  // namespace

std::vector<std::uint8_t> find_inverted(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                        const Orientation& orientation, const AabbTree& tree) {
  std::vector<Shell> shells(orientation.components);
  for (std::size_t f = 0; f < triangles.size(); ++f)
    if (const std::uint32_t component = orientation.component[f]; component != kNone)
      shells[component].faces.push_back(static_cast<std::uint32_t>(f));

  std::vector<std::uint8_t> inverted = orientation.turned;
  parallel_for(shells.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      Shell& shell = shells[s];
      shell.component = static_cast<std::uint32_t>(s);
      shell.inward = volume(shell, positions, triangles, orientation.turned) < 0;
      const bool is_hollow = shells.size() > 1 && hollow(shell, positions, triangles, orientation, tree);
      if (shell.inward != is_hollow)
        for (std::uint32_t f : shell.faces) inverted[f] ^= 1;
    }
  });
  return inverted;
}

}  // namespace sdm
