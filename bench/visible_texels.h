// Finds the texels of maps that a camera sees, by ray casting.
#pragma once

#include <sdm/surface.h>

#include <cstdint>
#include <span>
#include <vector>

namespace sdm::bench {

/// A perspective camera.
struct View {
  Vec3 eye{}, target{};
  Vec3 up{0, 0, 1};
  double field_of_view = 30;  ///< vertical, in degrees
  std::uint32_t width = 0, height = 0;
};

/// A surface in view of the camera.
struct Shown {
  const Surface* surface = nullptr;
  /// Omits the faces whose outside faces the camera, such as the near walls of a box around the scene.
  bool only_inside = false;
};

/// What the camera sees at a sample point of the picture.
struct Seen {
  std::uint32_t object = kNone;  ///< index into the list of surfaces, or kNone
  std::uint32_t texel = kNone;   ///< the texel whose sample is nearest in the atlas
  float light = 1;               ///< brightness: |cosine| of the angle between ray and normal
};

/// Returns what the camera sees at the centres of width × height pixels, by rows from the top.
[[nodiscard]] std::vector<Seen> visible_texels(const View& view, std::span<const Shown> objects);

}  // namespace sdm::bench
