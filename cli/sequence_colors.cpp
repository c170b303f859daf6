#include "sequence_colors.h"

#include <sdm/error.h>
#include <sdm/sites.h>

#include <algorithm>
#include <optional>

#include "src/io/page/player/sequence_player.h"

namespace {

constexpr std::size_t kFrames = 32;

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
  std::optional<sdm::ColorRange> widest;
  for (std::size_t frame = 0; frame < count; ++frame) {
    const bool measured = frame % stride == 0 || frame + 1 == count;
    if (!measured && !changes) continue;
    progress(frame);
    try {
      for (Body& body : bodies)
        if (!body.still()) {
          body.read(frame);
          body.followed();
        }
      if (!measured) continue;
      const sdm::Sites o1(mesh_of(bodies[0], changes)), o2(mesh_of(bodies[1], changes));
      sdm::SequencePlayer sample(o1.mesh(), o2.mesh(), both);
      sample.add(frame, o1, o2);
      const sdm::PictureOptions fixed = sample.colors(picture);
      const sdm::ColorRange colors{fixed.colormap, *fixed.range};
      widest = widest ? sdm::widest(*widest, colors) : colors;
    } catch (const sdm::Cancelled&) {
      throw;
    } catch (const sdm::Error&) {  // reported when the frame is used
    }
  }
  return widest ? sdm::fixed_colors(picture, *widest) : sdm::fixed_colors(picture, sdm::DistanceStatistics{});
}
