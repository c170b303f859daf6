#include "sequence_files.h"

#include <fmt/format.h>
#include <sdm/map_files.h>

#include <algorithm>
#include <iostream>
#include <limits>
#include <span>
#include <string_view>
#include <system_error>

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kOfO2 = "_o2";  // ends the names of O2's maps

}  // namespace

std::vector<fs::path> SequenceFiles::planned(const SequenceOutputs& outputs) {
  std::vector<fs::path> files{"frames.jsonl", "frames.csv"};
  if (outputs.player) files.emplace_back("player.html");
  if (outputs.animation) files.emplace_back("animation.glb");
  return files;
}

SequenceFiles::SequenceFiles(const SequenceCommand& command, OutputFolder& out,
                             const std::array<sdm::Mesh, 2>& first)
    : command_(command),
      out_(out),
      folder_(out.staging()),
      lines_(folder_ / "frames.jsonl", std::ios::binary) {
  if (command.outputs.collect()) player_.emplace(first[0], first[1], command.both);
}

void SequenceFiles::add_line(const nlohmann::ordered_json& json) {
  const std::string text = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  lines_ << text;
  if (command_.pair.json) std::cout << text << std::flush;
}

void SequenceFiles::write_maps(std::size_t frame, const MovingPair& pair, const FrameMaps& maps) {
  const fs::path folder = out_.staging("maps");
  std::vector<fs::path> written;
  try {
    for (int b = 0; b < command_.measured_bodies(); ++b) {
      const std::string name = fmt::format("{:04}{}", frame, b == 0 ? "" : kOfO2);
      sdm::write_exr(written.emplace_back(folder / (name + ".exr")), pair.surface(b), maps.of[b]);
      sdm::write_distance_png(written.emplace_back(folder / (name + ".png")), pair.surface(b), maps.of[b],
                              command_.picture);
    }
  } catch (...) {
    std::error_code ignored;
    for (const fs::path& file : written) fs::remove(file, ignored);
    throw;
  }
}

void SequenceFiles::collect(std::size_t frame, const MovingPair& pair) {
  if (player_) player_->add(frame, pair.sites(0), pair.sites(1));
}

void SequenceFiles::finish(const std::vector<Frame>& frames, const sdm::TemporalMaps& temporal,
                           const MovingPair& pair, FrameMaps& maps) {
  lines_.close();
  if (!lines_) throw_write_failure(folder_ / "frames.jsonl");
  write_text(folder_ / "frames.csv", to_csv(frames));
  listed_ = "frames.jsonl frames.csv";
  if (!frames.empty()) {
    write_plot(folder_ / "plot.png", frames, command_.pair.units);
    listed_ += " plot.png";
  }
  if (temporal.maps() > 0) {
    write_temporal(temporal, pair, maps);
    listed_ += " temporal.exr min.png mean.png max.png";
  }
  if (player_ && player_->frames() > 0) write_collected(frames);
  if (command_.outputs.maps_every > 0) listed_ += " maps/";
}

std::vector<std::string> SequenceFiles::notes() const {
  if (animated_frames_ == 0 || animated_frames_ == player_->frames()) return {};
  return {
      fmt::format("animation.glb has {} of {} frames, evenly spaced", animated_frames_, player_->frames())};
}

void SequenceFiles::write_temporal(const sdm::TemporalMaps& temporal, const MovingPair& pair,
                                   FrameMaps& maps) const {
  const sdm::Surface& surface = pair.surface(0);
  sdm::write_exr(folder_ / "temporal.exr", surface, temporal);
  // The pictures need the other layers of a map.
  sdm::DistanceMap& map = maps.of[0];
  if (map.distance.size() != surface.map_faces().size()) maps.compute(pair, 0);
  const auto use = [&](std::span<const float> values) { std::ranges::copy(values, map.distance.begin()); };
  // Faces without a texel have no values over time.
  std::fill(map.distance.begin() + static_cast<std::ptrdiff_t>(map.texels()), map.distance.end(),
            std::numeric_limits<float>::quiet_NaN());
  sdm::PictureOptions picture = command_.picture;
  if (!picture.range) {  // one scale for the three
    use(temporal.least());
    sdm::DistanceStatistics all = sdm::statistics(surface, map);
    use(temporal.largest());
    const sdm::DistanceStatistics largest = sdm::statistics(surface, map);
    all.max = largest.max;
    all.p99_abs = std::max(all.p99_abs, largest.p99_abs);
    picture = sdm::fixed_colors(picture, all);
  }
  const auto draw = [&](const char* file, std::span<const float> values) {
    use(values);
    sdm::write_distance_png(folder_ / file, surface, map, picture);
  };
  draw("min.png", temporal.least());
  draw("mean.png", temporal.mean());
  draw("max.png", temporal.largest());
}

void SequenceFiles::write_collected(const std::vector<Frame>& frames) {
  const PairCommand& pair = command_.pair;
  sdm::PlayerOptions options{.names = {pair.o1, pair.o2},
                             .xxh3 = xxh3_,
                             .units = pair.units,
                             .up = command_.picture.up,
                             .colors = command_.picture};
  if (command_.reading.rate) options.frames_per_second = *command_.reading.rate;
  if (command_.picture.tolerance) {
    options.verdicts.emplace().tolerance = *command_.picture.tolerance;
    for (const Frame& frame : frames) options.verdicts->of_frames.push_back(frame.verdict());
    options.verdicts->of_all = verdict_of(frames);
    options.verdicts->certified = is_certified(frames);
    if (options.verdicts->of_all == sdm::Verdict::doubtful)
      options.verdicts->doubt = deciding_frame(frames)->doubts.front().text;
  }
  if (command_.outputs.player) {
    player_->write(folder_ / "player.html", player_panels(frames, pair.units), options);
    listed_ += " player.html";
  }
  if (!command_.outputs.animation) return;
  animated_frames_ = player_->write_glb(folder_ / "animation.glb", options);
  listed_ += " animation.glb";
}
