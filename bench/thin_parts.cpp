#include "thin_parts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <numbers>
#include <utility>

namespace sdm::bench {
namespace {

constexpr double kPi = std::numbers::pi;

/// Radius and height.
using Profile = std::vector<Vec2>;

// The points of the polygon, and more between them, at most `step` apart.
Profile divided(const Profile& polygon, double step) {
  Profile result;
  for (std::size_t i = 0; i + 1 < polygon.size(); ++i) {
    const auto [r0, z0] = polygon[i];
    const auto [r1, z1] = polygon[i + 1];
    const int parts = std::max(1, static_cast<int>(std::ceil(std::hypot(r1 - r0, z1 - z0) / step)));
    for (int k = 0; k < parts; ++k) {
      const double t = static_cast<double>(k) / parts;
      result.push_back({r0 + t * (r1 - r0), z0 + t * (z1 - z0)});
    }
  }
  result.push_back(polygon.back());
  return result;
}

// Adds the surface that a profile sweeps about the z axis, oriented to the right of its direction. Points of
// radius 0 are one vertex; a profile that ends where it begins is closed.
void add_revolved(Mesh& mesh, const Profile& profile, std::uint32_t around) {
  const bool closed = profile.front() == profile.back();
  const std::size_t rows = profile.size() - (closed ? 1 : 0);
  std::vector<std::uint32_t> first;
  for (std::size_t row = 0; row < rows; ++row) {
    const auto [r, z] = profile[row];
    first.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
    for (std::uint32_t i = 0; i < (r == 0 ? 1 : around); ++i) {
      const double angle = 2 * kPi * i / around;
      mesh.positions.push_back({r * std::cos(angle), r * std::sin(angle), z});
    }
  }
  const auto at = [&](std::size_t row, std::uint32_t i) {
    return first[row % rows] + (profile[row % rows][0] == 0 ? 0 : i % around);
  };
  for (std::size_t row = 0; row + 1 < profile.size(); ++row)
    for (std::uint32_t i = 0; i < around; ++i) {
      if (profile[row + 1][0] != 0)
        mesh.triangles.push_back({at(row, i), at(row + 1, i + 1), at(row + 1, i)});
      if (profile[row][0] != 0) mesh.triangles.push_back({at(row, i), at(row, i + 1), at(row + 1, i + 1)});
    }
}

Mesh revolved(const Profile& polygon, std::uint32_t around, double step) {
  Mesh mesh;
  add_revolved(mesh, divided(polygon, step), around);
  return mesh;
}

// The profile of a wall along a line in the plane of radius and height, at half its thickness from it.
Profile wall(const std::function<Vec2(double)>& line, int parts) {
  const auto offset = [&](double t, double by) {
    const auto [r0, z0] = line(t - 1e-4);
    const auto [r1, z1] = line(t + 1e-4);
    const double length = std::hypot(r1 - r0, z1 - z0);
    const auto [r, z] = line(t);
    return Vec2{r + by * (z1 - z0) / length, z - by * (r1 - r0) / length};
  };
  Profile profile;
  for (int i = 0; i <= parts; ++i) profile.push_back(offset(static_cast<double>(i) / parts, 0.5 * kWall));
  for (int i = parts; i >= 0; --i) profile.push_back(offset(static_cast<double>(i) / parts, -0.5 * kWall));
  profile.push_back(profile.front());
  return profile;
}

void add_flipped(Mesh& mesh, const Mesh& shell) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), shell.positions.begin(), shell.positions.end());
  for (const auto& [a, b, c] : shell.triangles) mesh.triangles.push_back({first + a, first + c, first + b});
}

// An icosahedron, each face divided into 64, on a sphere.
Mesh geodesic_sphere(double radius) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  Mesh mesh;
  mesh.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                    {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int level = 0; level < 3; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> midpoints;
    const auto midpoint = [&](std::uint32_t a, std::uint32_t b) {
      const auto [entry, added] =
          midpoints.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.positions.size()));
      if (added) mesh.positions.push_back(0.5 * (mesh.positions[a] + mesh.positions[b]));
      return entry->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = midpoint(a, b), bc = midpoint(b, c), ca = midpoint(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  for (Vec3& p : mesh.positions) p = radius * normalized(p);
  return mesh;
}

Mesh hollow_ring() {
  Mesh mesh;
  for (const double radius : {0.3, 0.3 - kWall}) {
    Profile circle;
    constexpr int kParts = 24;
    for (int i = 0; i <= kParts; ++i) {
      const double angle = 2 * kPi * (i % kParts) / kParts;
      circle.push_back({0.8 + radius * std::cos(angle), radius * std::sin(angle)});
    }
    Mesh shell;
    add_revolved(shell, circle, 48);
    if (radius == 0.3)
      mesh = std::move(shell);
    else
      add_flipped(mesh, shell);
  }
  return mesh;
}

Mesh corrugated_sheet() {
  constexpr std::uint32_t kLong = 48, kWide = 12;
  Mesh mesh;
  for (const double side : {0.5, -0.5})
    for (std::uint32_t i = 0; i <= kLong; ++i)
      for (std::uint32_t j = 0; j <= kWide; ++j) {
        const double x = 2.0 * i / kLong - 1, slope = 0.15 * 4 * kPi * std::cos(4 * kPi * x);
        const double along = side * kWall / std::hypot(1, slope);
        mesh.positions.push_back(
            {x - along * slope, 2.0 * j / kWide - 1, 0.15 * std::sin(4 * kPi * x) + along});
      }
  const auto at = [](int side, std::uint32_t i, std::uint32_t j) {
    return static_cast<std::uint32_t>(side) * (kLong + 1) * (kWide + 1) + i * (kWide + 1) + j;
  };
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  for (std::uint32_t i = 0; i < kLong; ++i)
    for (std::uint32_t j = 0; j < kWide; ++j) {
      add(at(0, i, j), at(0, i + 1, j), at(0, i + 1, j + 1), at(0, i, j + 1));
      add(at(1, i, j), at(1, i, j + 1), at(1, i + 1, j + 1), at(1, i + 1, j));
    }
  for (std::uint32_t i = 0; i < kLong; ++i) {
    add(at(0, i, 0), at(1, i, 0), at(1, i + 1, 0), at(0, i + 1, 0));
    add(at(0, i, kWide), at(0, i + 1, kWide), at(1, i + 1, kWide), at(1, i, kWide));
  }
  for (std::uint32_t j = 0; j < kWide; ++j) {
    add(at(0, 0, j), at(0, 0, j + 1), at(1, 0, j + 1), at(1, 0, j));
    add(at(0, kLong, j), at(1, kLong, j), at(1, kLong, j + 1), at(0, kLong, j + 1));
  }
  return mesh;
}

// From the middle of the bottom up the outside, and back inside.
Profile cup_profile(double radius, double height) {
  return {{0, 0},    {radius, 0}, {radius, height}, {radius - kWall, height}, {radius - kWall, kWall},
          {0, kWall}};
}

}  // namespace

Mesh cup() {
  return revolved(cup_profile(1, 2), 32, 0.25);
}

Mesh hollow_sphere(double radius) {
  Mesh mesh = geodesic_sphere(radius);
  add_flipped(mesh, geodesic_sphere(radius - kWall));
  return mesh;
}

std::vector<ThinPart> thin_parts() {
  constexpr std::uint32_t kAround = 32;
  const auto of_wall = [&](const std::function<Vec2(double)>& line) {
    Mesh mesh;
    add_revolved(mesh, wall(line, 12), kAround);
    return mesh;
  };
  return {
      {"cup", cup()},
      {"hollow sphere", hollow_sphere(1)},
      {"tube", of_wall([](double t) {
         return Vec2{0.5, 2 * t - 1};
       })},
      {"bowl", revolved(
                   [] {
                     Profile profile;
                     constexpr int kParts = 10;
                     for (int i = 0; i <= kParts; ++i) {
                       const double angle = 0.5 * kPi * i / kParts;
                       profile.push_back({i == 0 ? 0 : std::sin(angle), -std::cos(angle)});
                     }
                     for (int i = kParts; i >= 0; --i) {
                       const double angle = 0.5 * kPi * i / kParts, r = 1 - kWall;
                       profile.push_back({i == 0 ? 0 : r * std::sin(angle), -r * std::cos(angle)});
                     }
                     return profile;
                   }(),
                   kAround, 1)},
      {"funnel", of_wall([](double t) {
         return Vec2{0.1 + 0.9 * t, 2 * t - 1};
       })},
      {"vase", of_wall([](double t) {
         return Vec2{0.6 + 0.25 * std::sin(5 * t), 2 * t - 1};
       })},
      {"flanged pipe", revolved({{0.4, -1},
                                 {1, -1},
                                 {1, -1 + kWall},
                                 {0.4 + kWall, -1 + kWall},
                                 {0.4 + kWall, 1},
                                 {0.4, 1},
                                 {0.4, -1}},
                                kAround, 0.25)},
      {"hollow ring", hollow_ring()},
      {"corrugated sheet", corrugated_sheet()},
      {"square tray", revolved(cup_profile(1, 0.6), 4, 3)},
  };
}

}  // namespace sdm::bench
