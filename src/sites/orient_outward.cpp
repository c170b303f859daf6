#include "sites/orient_outward.h"

#include <algorithm>
#include <numeric>

#include "core/geometry/vec.h"
#include "core/parallel.h"

namespace sdm::sites {
namespace {

constexpr std::size_t kGrain = 4096;

struct Shell {
  std::uint32_t component;
  std::span<const std::uint32_t> faces;
  bool inward = false;  ///< as flipped by the orientation, the faces enclose a negative volume
};

// Six times the volume. A corner of the shell as origin preserves the precision of small shells. Summed in
// parts that do not depend on the number of threads.
double volume(const Shell& shell, const inside::FaceTree& faces, std::span<const std::uint8_t> flipped) {
  const std::span<const Vec3> p = faces.positions;
  const Vec3& origin = p[faces.triangles[shell.faces.front()][0]];
  thread_local std::vector<double> parts_of_this_thread;  // a thread waiting for a loop starts no other shell
  std::vector<double>& parts = parts_of_this_thread;
  parts.assign((shell.faces.size() + kGrain - 1) / kGrain, 0);
  parallel_for(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (const std::uint32_t f :
           shell.faces.subspan(i * kGrain).first(std::min(kGrain, shell.faces.size() - i * kGrain))) {
        const Triangle& t = faces.triangles[f];
        const double v = dot(p[t[0]] - origin, cross(p[t[1]] - origin, p[t[2]] - origin));
        parts[i] += flipped[f] ? -v : v;
      }
  });
  return std::accumulate(parts.begin(), parts.end(), 0.0);
}

// Whether the shell lies inside an odd number of others. Shells that touch or overlap others are at most
// partly inside them, so a few points just outside faces that are far apart must all agree.
bool hollow(const Shell& shell, const inside::FaceTree& faces, const mesh::Orientation& orientation) {
  constexpr std::size_t kPoints = 5;
  constexpr double kOff = 1e-7;  // in the unit frame
  for (std::size_t i = 0; i < kPoints; ++i) {
    const std::uint32_t f = shell.faces[i * shell.faces.size() / kPoints];
    const auto corner = [&](int k) { return faces.frame.to_unit(faces.positions[faces.triangles[f][k]]); };
    const Vec3 a = corner(0), b = corner(1), c = corner(2);
    const Vec3 normal = normalized(cross(b - a, c - a));
    const bool inward = shell.inward != static_cast<bool>(orientation.flipped[f]);
    const Vec3 point = (1.0 / 3) * (a + b + c) + (inward ? -kOff : kOff) * normal;
    if (!inside::odd_crossings(faces, point, orientation.component, shell.component)) return false;
  }
  return true;
}

}  // namespace

Shells find_shells(const mesh::Orientation& orientation) {
  return make_rows<std::uint32_t>(orientation.first_face.size(), [&](const auto& put) {
    for (std::uint32_t f = 0; f < orientation.component.size(); ++f)
      if (orientation.component[f] != kNone) put(orientation.component[f], f);
  });
}

void orient_outward(const inside::FaceTree& faces, const mesh::Orientation& orientation, const Shells& shells,
                    std::vector<std::uint8_t>& inverted) {
  inverted = orientation.flipped;
  parallel_for(shells.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      Shell shell{static_cast<std::uint32_t>(s), shells.of(s)};
      shell.inward = volume(shell, faces, orientation.flipped) < 0;
      const bool is_hollow = shells.size() > 1 && hollow(shell, faces, orientation);
      if (shell.inward != is_hollow)
        for (std::uint32_t f : shell.faces) inverted[f] ^= 1;
    }
  });
}

}  // namespace sdm::sites
