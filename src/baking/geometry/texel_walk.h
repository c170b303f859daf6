// Walks over the texels of a surface, for what is baked.
#pragma once

#include <sdm/match.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/barycentric.h"
#include "geometry/triangle.h"
#include "surface/surface_data.h"

namespace sdm::baking {

inline constexpr float kNoValue = std::numeric_limits<float>::quiet_NaN();

/// Returns no values for all texels, `components` each. Throws sdm::Error if there is not enough memory.
[[nodiscard]] inline std::vector<float> no_values(const TexelMatches& matches, std::size_t components,
                                                  std::string_view purpose) {
  const std::size_t count = components * matches.face.size();
  require_memory(count * sizeof(float), purpose);
  return std::vector<float>(count, kNoValue);
}

/// Where texels are on their faces. The face of the last one is kept.
class TexelPlaces {
 public:
  explicit TexelPlaces(const surface::SurfaceData& surface) : surface_(surface) {}

  struct Place {
    std::uint32_t face;
    Vec3 point, weights;
  };
  [[nodiscard]] Place at(std::uint32_t texel) {
    const std::uint32_t face = surface_.map_faces[texel];
    if (face != face_) {
      face_ = face;
      frame_ = BarycentricFrame(corners_of(surface_.mesh, face));
    }
    const Vec3 point = surface_.texel_point(face, texel);
    return {face, point, frame_.weights(point)};
  }

 private:
  const surface::SurfaceData& surface_;
  std::uint32_t face_ = kNone;
  BarycentricFrame frame_;
};

/// Calls body(begin, end) for ranges of the texels of whole rows, in parallel.
template <class Body>
void for_each_rows(const Surface& surface, const Progress& progress, std::string_view step,
                   const Body& body) {
  constexpr std::size_t kRowsOfTask = 8;
  const std::size_t width = surface.resolution();
  parallel_for(surface.rows(), kRowsOfTask, progress, step, [&](std::size_t begin, std::size_t end) {
    body(static_cast<std::uint32_t>(begin * width), static_cast<std::uint32_t>(end * width));
  });
}

/// Calls body(texel, state) for the texels of whole rows, in parallel; make_state() makes what one thread
/// keeps.
template <class MakeState, class Body>
void for_each_texel(const Surface& surface, const Progress& progress, std::string_view step,
                    const MakeState& make_state, const Body& body) {
  for_each_rows(surface, progress, step, [&](std::uint32_t begin, std::uint32_t end) {
    auto state = make_state();
    for (std::uint32_t i = begin; i < end; ++i) body(i, state);
  });
}

/// The point of the mesh that a SurfacePoint is.
[[nodiscard]] inline Vec3 position_of(const Mesh& mesh, const SurfacePoint& point) {
  const auto [a, b, c] = corners_of(mesh, point.face);
  return point.barycentric[0] * a + point.barycentric[1] * b + point.barycentric[2] * c;
}

}  // namespace sdm::baking
