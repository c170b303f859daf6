// Pictures of maps on their surfaces, by ray casting.
#pragma once

#include <sdm/surface.h>

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "io/image/pictures/picture.h"

namespace sdm::figures {

/// A perspective camera and its picture.
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

/// What the camera sees at a point of the picture.
struct Seen {
  std::uint32_t object = kNone;  ///< index into the list of surfaces, or kNone
  std::uint32_t texel = kNone;   ///< the owned texel nearest to the point in the atlas
  float light = 1;               ///< |cosine| of the angle between ray and normal
};

/// What a camera sees, to be painted in several ways.
class Scenery {
 public:
  /// Casts four rays for each pixel. The surfaces need not outlive this. Cost: one first hit for each ray.
  Scenery(const View& view, std::span<const Shown> objects);

  /// The mean of `color`, darkened by the light, over the rays of each pixel; white where there is no
  /// surface. `color` may be called from several threads at once, and is not called without a texel.
  [[nodiscard]] io::Picture paint(const std::function<io::Rgb(const Seen&)>& color) const;

 private:
  std::uint32_t width_, height_;
  std::vector<Seen> seen_;  ///< by rows of samples, two for each pixel in each direction
};

/// A camera that sees all of these bounds from a direction, which need not have length 1.
[[nodiscard]] View view_of(const Box& bounds, const Vec3& from, std::uint32_t width, std::uint32_t height);

}  // namespace sdm::figures
