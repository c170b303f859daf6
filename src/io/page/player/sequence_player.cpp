#include "io/page/player/sequence_player.h"

#include <sdm/error.h>
#include <sdm/map.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <vector>

#include "core/cancellation.h"
#include "core/memory.h"
#include "io/page/player/animated_model.h"
#include "io/page/player/drawn_body.h"
#include "io/page/player/player_page.h"

namespace sdm {

using namespace io;

namespace {

constexpr std::size_t kMostCoordinates = 8'000'000;  // of all frames

/// The distances of all frames together: of the vertices drawn, each with the same weight.
DistanceStatistics pooled(const std::vector<PlayerFrame>& frames) {
  DistanceStatistics s;
  s.min = kInfinity;
  s.max = -s.min;
  std::vector<float> values, magnitudes;
  for (const PlayerFrame& frame : frames)
    for (const auto& distances : frame.distances)
      for (const float d : distances) {
        if (!std::isfinite(d)) continue;
        s.min = std::min<double>(s.min, d);
        s.max = std::max<double>(s.max, d);
        values.push_back(d);
        magnitudes.push_back(std::abs(d));
      }
  s.texels = magnitudes.size();
  if (magnitudes.empty()) return {};
  const auto percentile = [](std::vector<float>& of, double share) {
    const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(of.size() - 1));
    std::ranges::nth_element(of, of.begin() + place);
    return of[static_cast<std::size_t>(place)];
  };
  s.p05 = percentile(values, 0.05);
  s.p95 = percentile(values, 0.95);
  s.p99_abs = percentile(magnitudes, 0.99);
  return s;
}

std::vector<Vec3f> as_floats(const std::vector<Vec3>& positions) {
  std::vector<Vec3f> result;
  result.reserve(positions.size());
  for (const Vec3& p : positions)
    result.push_back({static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
  return result;
}

}  // namespace

struct SequencePlayer::Impl {
  std::array<DrawnBody, 2> bodies;
  bool both;
  std::vector<PlayerFrame> frames;  // one of `stride` of those added
  std::vector<std::size_t> added;   // their numbers
  std::size_t stride = 1;

  [[nodiscard]] std::size_t numbers_of_frame() const {
    return 3 * (bodies[0].vertices() + bodies[1].vertices());
  }

  [[nodiscard]] PlayerContent content(std::span<const PlotPanel> panels) const {
    return {.frames = frames,
            .added = added,
            .stride = stride,
            .triangles = {bodies[0].triangles(), bodies[1].triangles()},
            .panels = panels};
  }

  /// Leaves every second frame. Does not fail.
  void thin_out() {
    for (std::size_t i = 1; 2 * i < frames.size(); ++i) frames[i] = std::move(frames[2 * i]);
    frames.erase(frames.begin() + static_cast<std::ptrdiff_t>((frames.size() + 1) / 2), frames.end());
    stride *= 2;
  }
};

SequencePlayer::SequencePlayer(const Mesh& o1, const Mesh& o2, bool both)
    : impl_(new Impl{{DrawnBody(o1), DrawnBody(o2)}, both, {}, {}, 1}) {}
SequencePlayer::~SequencePlayer() = default;
SequencePlayer::SequencePlayer(SequencePlayer&&) noexcept = default;
SequencePlayer& SequencePlayer::operator=(SequencePlayer&&) noexcept = default;

PictureOptions SequencePlayer::colors(const PictureOptions& options) const {
  return fixed_colors(options, pooled(impl_->frames));
}

std::size_t SequencePlayer::frames() const {
  return impl_->added.size();
}

void SequencePlayer::add(std::size_t frame, const Sites& o1, const Sites& o2) try {
  const Uncancellable whole;
  const std::array<const Sites*, 2> sites{&o1, &o2};
  for (int b = 0; b < 2; ++b)
    if (!impl_->bodies[b].fits(sites[b]->mesh()))
      throw Error("a frame of a player has other triangles than the first one");
  const std::size_t number = impl_->added.size();
  reserve_for(impl_->added, number + 1);
  if (number % impl_->stride != 0) {
    impl_->added.push_back(frame);
    return;
  }
  PlayerFrame shown{.number = number, .positions = {}, .distances = {}};
  for (int b = 0; b < 2; ++b) {
    const Mesh mesh = impl_->bodies[b].mesh(sites[b]->mesh().positions);
    if (b == 0 || impl_->both) shown.distances[b] = distances_at_vertices(mesh, *sites[1 - b]);
    shown.positions[b] = as_floats(mesh.positions);
  }
  impl_->frames.push_back(std::move(shown));
  impl_->added.push_back(frame);  // this and what follows does not fail
  if (impl_->frames.size() > 2 && impl_->frames.size() * impl_->numbers_of_frame() > kMostCoordinates)
    impl_->thin_out();
} catch (const std::bad_alloc&) {
  throw out_of_memory("the frames of a player");
}

void SequencePlayer::write(const std::filesystem::path& file, std::span<const PlotPanel> panels,
                           const PlayerOptions& options) const try {
  if (impl_->added.empty()) throw Error("cannot write " + file.string() + ": there are no frames");
  for (const PlotPanel& panel : panels)
    for (const Curve& curve : panel.curves)
      if (curve.values.size() != impl_->added.size())
        throw Error("cannot write " + file.string() + ": a curve needs one value for each frame");
  if (options.verdicts && options.verdicts->of_frames.size() != impl_->added.size())
    throw Error("cannot write " + file.string() + ": verdicts need one for each frame");
  write_player_page(file, impl_->content(panels), options, colors(options.colors));
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

std::size_t SequencePlayer::write_glb(const std::filesystem::path& file, const PlayerOptions& options) const
    try {
  if (impl_->added.empty()) throw Error("cannot write " + file.string() + ": there are no frames");
  if (!(options.frames_per_second > 0))
    throw Error("cannot write " + file.string() + ": the number of frames per second must be positive");
  return write_animated_model(file, impl_->content({}), options, colors(options.colors));
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

}  // namespace sdm
