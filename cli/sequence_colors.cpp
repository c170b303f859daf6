#include "sequence_colors.h"

#include <sdm/error.h>
#include <sdm/player.h>
#include <sdm/progress.h>
#include <sdm/sites.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace {

constexpr std::size_t kFrames = 32;

/// The widest of several scales.
class WidestScale {
 public:
  void add(const sdm::PictureOptions& fixed) {
    if (!scale_) {
      scale_ = fixed;
      return;
    }
    auto& [lo, hi] = *scale_->range;
    lo = std::min(lo, (*fixed.range)[0]), hi = std::max(hi, (*fixed.range)[1]);
    if (fixed.colormap == sdm::Colormap::diverging) scale_->colormap = fixed.colormap;
  }
  [[nodiscard]] std::optional<sdm::PictureOptions> scale() const {
    std::optional<sdm::PictureOptions> scale = scale_;
    if (scale && scale->colormap == sdm::Colormap::diverging) {
      const double reach = std::max(std::abs((*scale->range)[0]), std::abs((*scale->range)[1]));
      scale->range = {-reach, reach};
    }
    return scale;
  }

 private:
  std::optional<sdm::PictureOptions> scale_;
};

/// The body in the frame that was read last.
sdm::Mesh mesh_of(const Body& body, bool changes) {
  sdm::Mesh mesh = body.mesh();
  if (!changes && !body.still()) mesh.positions.assign(body.positions().begin(), body.positions().end());
  return mesh;
}

}  // namespace

sdm::PictureOptions colors_for_frames(const std::function<std::array<Body, 2>()>& open,
                                      const sdm::PictureOptions& picture, bool both, bool changes,
                                      const std::function<void(std::size_t)>& progress) {
  std::array<Body, 2> bodies = open();
  const std::size_t count = common_frames(bodies[0], bodies[1]);
  const std::size_t stride = std::max<std::size_t>(1, (count + kFrames - 1) / kFrames);
  WidestScale widest;
  for (std::size_t frame = 0; frame < count; ++frame) {
    const bool measured = frame % stride == 0 || frame + 1 == count;
    if (!measured && !changes) continue;
    progress(frame);
    try {
      for (Body& body : bodies)
        if (!body.still()) body.read(frame), body.followed();
      if (!measured) continue;
      const sdm::Sites o1(mesh_of(bodies[0], changes)), o2(mesh_of(bodies[1], changes));
      sdm::SequencePlayer sample(o1.mesh(), o2.mesh(), both);
      sample.add(frame, o1, o2);
      widest.add(sample.colors(picture));
    } catch (const sdm::Cancelled&) {
      throw;
    } catch (const sdm::Error&) {  // reported when the frame is used
    }
  }
  return widest.scale().value_or(sdm::fixed_colors(picture, {}));
}
