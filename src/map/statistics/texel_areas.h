// The area that a sample stands for.
#pragma once

#include <sdm/surface.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "geometry/triangle.h"
#include "surface/surface_data.h"

namespace sdm::map {

[[nodiscard]] inline double face_area(const Mesh& mesh, std::uint32_t face) {
  const auto [a, b, c] = corners_of(mesh, face);
  return 0.5 * norm(cross(b - a, c - a));
}

/// The area of all faces that are not removed. Cost: linear.
[[nodiscard]] inline double surface_area(const Mesh& mesh) {
  double area = 0;
  for (std::uint32_t face = 0; face < mesh.triangles.size(); ++face)
    if (!is_removed(mesh.triangles[face])) area += face_area(mesh, face);
  return area;
}

/// The surface area of a sample of each face; all together add up to that of the mesh, but for faces without
/// a sample, which have 0.
///
/// The sample of a face without a texel has the area of the face, and the texels of a large face share its
/// area. Those of small faces must not: of faces of about two texels, the ones that own a single texel have
/// it near their middle, so that middles would weigh too much. There, texels weigh |∂p/∂u × ∂p/∂v|, as all
/// positions in a face are equally likely then, times a factor that is common to all faces of about the same
/// size in the atlas: it makes up for those of them without a texel. Cost: linear in faces.
[[nodiscard]] inline std::vector<double> texel_areas(const Surface& surface) {
  constexpr double kFewTexels = 256;
  constexpr int kStrataPerOctave = 4, kStrata = 16 * kStrataPerOctave;
  struct Stratum {
    double faces = 0, texels = 0;  ///< areas
  };
  std::array<Stratum, kStrata> strata;
  const std::vector<std::uint32_t>& samples = internals(surface).face_samples;
  std::vector<double> areas(samples.size());
  std::vector<std::uint8_t> own(samples.size());
  for (const std::uint32_t face : surface.map_faces().subspan(surface.texel_faces().size())) own[face] = 1;
  std::vector<std::uint8_t> stratum_of(samples.size(), kStrata);  // kStrata: of none
  for (std::uint32_t face = 0; face < areas.size(); ++face) {
    if (samples[face] == 0) continue;
    const double area = face_area(surface.mesh(), face);
    areas[face] = area / samples[face];
    if (own[face] != 0) continue;
    const auto [u, v] = surface.texel_edges(face);
    const double texel = norm(cross(u, v)), size = area / texel;
    if (!(size > 0 && size < kFewTexels)) continue;
    const int below =
        std::min(static_cast<int>(kStrataPerOctave * std::log2(kFewTexels / size)), kStrata - 1);
    stratum_of[face] = static_cast<std::uint8_t>(below);
    areas[face] = texel;
    strata[below].faces += area;
    strata[below].texels += samples[face] * texel;
  }
  for (std::uint32_t face = 0; face < areas.size(); ++face)
    if (stratum_of[face] < kStrata)
      areas[face] *= strata[stratum_of[face]].faces / strata[stratum_of[face]].texels;
  return areas;
}

}  // namespace sdm::map
