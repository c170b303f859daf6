// Surfaces and maps for the tests of the writers, and a folder for what they write.
#pragma once

#include <sdm/io.h>

#include <unistd.h>
#include <cmath>
#include <filesystem>
#include <functional>
#include <numbers>
#include <string>

namespace sdm::test {

/// A torus of 2·n·n triangles, moved to `origin`; radii 1 and 0.4 times `size`.
inline Mesh torus(std::uint32_t n, double size = 1, const Vec3& origin = {}) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      const double a = 2 * std::numbers::pi * i / n, b = 2 * std::numbers::pi * j / n,
                   r = 1 + 0.4 * std::cos(b);
      mesh.positions.push_back({origin[0] + size * r * std::cos(a), origin[1] + size * r * std::sin(a),
                                origin[2] + size * 0.4 * std::sin(b)});
    }
  const auto at = [n](std::uint32_t i, std::uint32_t j) { return (i % n) * n + j % n; };
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

using Field = std::function<double(const Vec3&)>;

/// A map whose distances are those of `field` where it is not NaN, and whose other values are made up but
/// never repeat by chance. Where it is infinite there is nothing in range, as self maps say it.
inline DistanceMap map_of(const Surface& surface, const Field& field) {
  DistanceMap map;
  map.resolution = surface.resolution();
  const std::size_t texels = surface.texel_faces().size();
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  map.distance.assign(texels, kNaN);
  map.vector.assign(texels, {kNaN, kNaN, kNaN});
  map.site.assign(texels, kNone);
  map.site_type.assign(texels, SiteType::none);
  map.sign = {SignMethod::pseudonormal, "made up"};
  for (const std::uint32_t texel : surface.sample_texels()) {
    const double d = field(surface.texel_point(texel));
    if (std::isnan(d)) {
      ++map.beyond_max_distance;
      continue;
    }
    map.distance[texel] = static_cast<float>(d);
    if (std::isinf(d)) {
      ++map.beyond_max_distance;
      map.vector[texel] = {0, 0, 0};
      continue;
    }
    map.vector[texel] = {static_cast<float>(d), static_cast<float>(texel),
                         -1.f / static_cast<float>(texel + 1)};
    map.site[texel] = texel;
    map.site_type[texel] = static_cast<SiteType>(texel % 3);
  }
  return map;
}

inline std::vector<float> at_vertices(const Mesh& mesh, const Field& field) {
  std::vector<float> result;
  for (const Vec3& p : mesh.positions) result.push_back(static_cast<float>(field(p)));
  return result;
}

/// An empty folder of this process's own, removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "sdm-test-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] bool empty() const { return std::filesystem::is_empty(path_); }

 private:
  std::filesystem::path path_;
};

}  // namespace sdm::test
