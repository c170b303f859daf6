// Open meshes, points about them, and their winding numbers.
#pragma once

#include <sdm/sdm.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "sites/sites_data.h"
#include "support/meshes.h"
#include "support/shapes.h"

namespace sdm::test {

using Extended = std::array<long double, 3>;

inline long double dot_of(const Extended& a, const Extended& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// The winding number by the sum over all faces as they are oriented, in extended precision.
inline double brute_force_winding(const Sites& sites, const Vec3& q) {
  const sites::SitesData& data = internals(sites);
  long double sum = 0;
  for (std::uint32_t f = 0; f < data.mesh.triangles.size(); ++f) {
    if (data.topology.ignored(f)) continue;
    std::array<Extended, 3> r;
    std::array<long double, 3> length;
    for (int i = 0; i < 3; ++i) {
      const Vec3& p = data.mesh.positions[data.mesh.triangles[f][i]];
      for (int k = 0; k < 3; ++k) r[i][k] = static_cast<long double>(p[k]) - q[k];
      length[i] = std::sqrt(dot_of(r[i], r[i]));
    }
    const auto& [a, b, c] = r;
    const Extended normal{b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]};
    const long double angle =
        2 * std::atan2(dot_of(a, normal), length[0] * length[1] * length[2] + dot_of(a, b) * length[2] +
                                              dot_of(b, c) * length[0] + dot_of(c, a) * length[1]);
    sum += data.inverted[f] ? -angle : angle;
  }
  return static_cast<double>(sum / (4 * std::numbers::pi_v<long double>));
}

inline Mesh without_faces(Mesh mesh, const auto& drop) {
  std::size_t f = 0;
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    const Vec3 centre = (1.0 / 3) * (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]);
    return drop(f++, centre);
  });
  return mesh;
}

/// Each triangle with corners of its own, all at slightly different places.
inline Mesh soup_of(const Mesh& mesh) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> noise(-1e-3, 1e-3);
  Mesh soup;
  for (const Triangle& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.positions.size());
    for (const std::uint32_t v : t) {
      const Vec3& p = mesh.positions[v];
      soup.positions.push_back({p[0] + noise(random), p[1] + noise(random), p[2] + noise(random)});
    }
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  return soup;
}

/// A strip with one side, around the z axis.
inline Mesh moebius_strip() {
  Mesh mesh;
  constexpr std::uint32_t kParts = 40;
  for (std::uint32_t i = 0; i < kParts; ++i) {
    const double turn = 2 * std::numbers::pi * i / kParts;
    for (const double s : {-0.3, 0.3}) {
      const double r = 1 + s * std::cos(turn / 2);
      mesh.positions.push_back({r * std::cos(turn), r * std::sin(turn), s * std::sin(turn / 2)});
    }
  }
  for (std::uint32_t i = 0; i < kParts; ++i) {
    const bool last = i + 1 == kParts;
    const std::uint32_t a = 2 * i, b = 2 * i + 1, c = last ? 1 : a + 2, d = last ? 0 : b + 2;
    mesh.triangles.push_back({a, c, b});
    mesh.triangles.push_back({b, c, d});
  }
  return mesh;
}

struct OpenMesh {
  std::string name;
  Mesh mesh;
};

inline std::vector<OpenMesh> open_meshes() {
  const Mesh ball = sphere(4), elephant = load("elephant-with-holes.off", "fit");
  // An edge of three faces, and shells of both orientations that overlap.
  Mesh fin = cube();
  fin.positions.push_back({3, 0.2, 0.1});
  fin.triangles.push_back({0, 1, static_cast<std::uint32_t>(fin.positions.size() - 1)});
  return {
      {"half a ball", without_faces(ball, [](std::size_t, const Vec3& c) { return c[2] > 0.1; })},
      {"a ball with many holes", without_faces(ball, [](std::size_t f, const Vec3&) { return f % 29 == 0; })},
      {"half of the faces of a ball",
       without_faces(ball, [](std::size_t f, const Vec3&) { return f % 2 == 0; })},
      {"soup", soup_of(sphere(3))},
      {"separate triangles that meet",
       [&] {
         Mesh mesh = soup_of(sphere(2));
         for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
           for (int k = 0; k < 3; ++k)
             mesh.positions[mesh.triangles[i][k]] = sphere(2).positions[sphere(2).triangles[i][k]];
         mesh.triangles.pop_back();
         return mesh;
       }()},
      {"a cube with a fin", fin},
      {"a strip with one side", moebius_strip()},
      {"two open shells that overlap",
       joined(without_faces(ball, [](std::size_t, const Vec3& c) { return c[0] > 0.4; }),
              moved(flipped(without_faces(ball, [](std::size_t, const Vec3& c) { return c[1] > 0.2; })),
                    {0.5, 0.2, 0.1}))},
      {"elephant", elephant},
  };
}

/// In the box, near the mesh, on the planes of holes, and on lines between vertices, which closing faces
/// share.
inline std::vector<Vec3> points_about(const Mesh& mesh, std::size_t count) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> u(-1.2, 1.2), small(-0.02, 0.02);
  const auto vertex = [&] { return mesh.positions[random() % mesh.positions.size()]; };
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    points.push_back({u(random), u(random), u(random)});
    const Vec3 near = vertex();
    points.push_back({near[0] + small(random), near[1] + small(random), near[2] + small(random)});
    points.push_back(0.5 * (vertex() + vertex()));
    points.push_back((1.0 / 3) * (vertex() + vertex() + vertex()));
  }
  return points;
}

}  // namespace sdm::test
