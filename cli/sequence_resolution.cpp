#include "sequence_resolution.h"

#include <fmt/format.h>
#include <sdm/error.h>
#include <sdm/surface.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "format.h"
#include "sequence_bound.h"

namespace {

constexpr std::uint32_t kLargest = 32768, kStep = 16;

// The largest distance between positions of the same vertex.
double motion(std::span<const sdm::Vec3> from, std::span<const sdm::Vec3> to) {
  double largest = 0;
  for (std::size_t v = 0; v < from.size(); ++v)
    largest =
        std::max(largest, std::hypot(to[v][0] - from[v][0], to[v][1] - from[v][1], to[v][2] - from[v][2]));
  return largest;
}

// Changes the surface as the frame that was read has changed. What the atlas cannot take gets a new one, as
// in the frame itself.
void follow(Body& body, const sdm::TopologyChange& change, sdm::Surface& surface,
            const sdm::AtlasOptions& atlas) {
  bool edited = !change.replaced;
  if (edited) try {
      surface.edit(change.edit);
    } catch (const sdm::Error&) {
      edited = false;
    }
  if (!edited) surface = sdm::Surface(body.mesh(), atlas);
  body.followed();
}

struct WorstFrame {
  double bound = 0;
  std::size_t frame = 0;
};

// The largest error bound over all frames, or one of at most `precision` if none is larger.
WorstFrame worst_frame(Body body, const sdm::AtlasOptions& atlas, double precision,
                       const std::function<void(std::size_t)>& progress) {
  sdm::Surface surface(body.mesh(), atlas);
  FrameBound bound(surface);
  WorstFrame worst{bound.value(), 0};
  std::vector<sdm::Vec3> measured = surface.mesh().positions;
  for (std::size_t frame = 0; frame < body.frames() && !body.still(); ++frame) {
    progress(frame);
    try {
      body.read(frame);
      if (const sdm::TopologyChange change = body.change(); change.none()) {
        surface.refit(body.positions());
        // A frame that has moved little needs no measurement.
        if (!bound.has_history() && bound.value_after(motion(measured, body.positions())) <= precision)
          continue;
      } else {
        follow(body, change, surface, atlas);
        bound.rebuild(surface);
      }
    } catch (const sdm::Cancelled&) {
      throw;
    } catch (const sdm::Error&) {  // reported when the frame is used
      continue;
    }
    bound.measure(surface, precision);
    measured = surface.mesh().positions;
    if (bound.value() > worst.bound) worst = {bound.value(), frame};
  }
  return worst;
}

}  // namespace

std::uint32_t resolution_for_frames(const std::function<Body()>& open, const sdm::AtlasOptions& atlas,
                                    double precision, const std::function<void(std::size_t)>& progress) {
  sdm::AtlasOptions options = atlas;
  options.resolution = sdm::resolution_for(open().mesh(), precision, atlas);
  for (;;) {
    const WorstFrame worst = worst_frame(open(), options, precision, progress);
    if (worst.bound <= precision) return options.resolution;
    if (options.resolution == kLargest)
      throw sdm::Error(
          fmt::format("a precision of {} needs more than {} texels per side in frame {}; give a "
                      "larger --map-precision",
                      number(precision), kLargest, worst.frame));
    // The bound is about proportional to 1 / resolution.
    constexpr double kReserve = 1.02;
    const double wanted = std::ceil(kReserve * options.resolution * worst.bound / precision / kStep) * kStep;
    options.resolution = static_cast<std::uint32_t>(
        std::min<double>(kLargest, std::max<double>(wanted, options.resolution + kStep)));
  }
}
