// The results of a sequence, as lines of JSON, as a table and as a plot. The keys and columns are documented
// in docs/proximity.md.
#pragma once

#include <sdm/io.h>
#include <sdm/sdm.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "exit_codes.h"
#include "sequence_distances.h"

/// Milliseconds of the steps of a frame.
struct FrameTimes {
  double read = 0, update = 0, query = 0, error = 0, map = 0, write = 0;
  [[nodiscard]] double total() const { return read + update + query + error + map + write; }
};

/// How the topology of a body has changed since the frame before.
struct TopologyReport {
  std::size_t removed_faces = 0, reconnected_faces = 0, added_faces = 0;
  bool new_layout = false;  ///< nothing stays: the body has another mesh and another atlas
};

template <>
inline constexpr std::tuple sdm::kFields<FrameTimes>{
    Field{"read", &FrameTimes::read, "Reading the meshes."},
    Field{"update", &FrameTimes::update, "Moving the bodies."},
    Field{"query", &FrameTimes::query, "The queries."},
    Field{"error", &FrameTimes::error, "The error bound."},
    Field{"map", &FrameTimes::map, "The maps."},
    Field{"write", &FrameTimes::write, "Writing files."}};
template <>
inline constexpr std::tuple sdm::kFields<TopologyReport>{
    Field{"removed_faces", &TopologyReport::removed_faces, "Faces that are gone."},
    Field{"reconnected_faces", &TopologyReport::reconnected_faces, "Faces with other vertices."},
    Field{"added_faces", &TopologyReport::added_faces, "Faces that are new."},
    Field{"new_layout", &TopologyReport::new_layout, "Whether the body has another mesh and another atlas."}};

struct Frame {
  std::size_t index = 0;
  sdm::BoundedLength separation;
  bool colliding = false;
  std::optional<sdm::BoundedLength> depth;
  std::size_t contacts = 0, patches = 0;
  std::array<double, 2> error_bound{};                       ///< of each body: covering radius
  std::array<double, 2> relative_error{};                    ///< of each body: see sdm::RelativeError
  std::array<std::optional<TopologyReport>, 2> topology{};   ///< of bodies that have changed
  std::uint32_t resolution = 0;                              ///< texels per row of O1's atlas
  std::array<std::optional<FrameDistances>, 2> distances{};  ///< of each body, where asked for
  std::vector<sdm::Doubt> doubts{};                          ///< of a tolerance
  FrameTimes time;

  /// Makes each PASS doubtful, if there are doubts.
  void withhold_pass() {
    if (doubts.empty()) return;
    for (auto& d : distances)
      if (d) d->withhold_pass();
  }
  /// The verdict on both bodies; a pass without a tolerance.
  [[nodiscard]] sdm::Verdict verdict() const {
    sdm::Verdict both = sdm::Verdict::pass;
    for (const auto& d : distances)
      if (d) both = worse(both, d->judged());
    return both;
  }
};

/// The verdict on all frames; a pass without a tolerance.
[[nodiscard]] sdm::Verdict verdict_of(const std::vector<Frame>& frames);
/// The first frame whose verdict is that on all frames; null without frames.
[[nodiscard]] const Frame* deciding_frame(const std::vector<Frame>& frames);
/// Whether that is proven: PASS in each frame, FAIL in one.
[[nodiscard]] bool is_certified(const std::vector<Frame>& frames);

/// A frame that could not be used.
struct BadFrame {
  std::size_t index = 0;
  std::string fault;
};

/// One line of JSON. `contacts` are those of the frame; the deepest of each contact patch is reported.
[[nodiscard]] nlohmann::ordered_json to_json(const Frame& frame, std::span<const sdm::Contact> contacts);
[[nodiscard]] nlohmann::ordered_json to_json(const BadFrame& frame);

/// The inverse of to_json(frame, ...).
[[nodiscard]] Frame frame_from(const nlohmann::ordered_json& line);
[[nodiscard]] BadFrame bad_frame_from(const nlohmann::ordered_json& line);
[[nodiscard]] bool is_bad(const nlohmann::ordered_json& line);

/// frames.csv: one row for each frame that was used.
[[nodiscard]] std::string to_csv(const std::vector<Frame>& frames);
/// The curves of player.html, with one value for each frame; of penetration only if there is one.
[[nodiscard]] std::vector<sdm::PlotPanel> player_panels(const std::vector<Frame>& frames,
                                                        const std::string& units);
/// plot.png: separation, depth, relative error and time over frames, with gaps for skipped frames.
void write_plot(const std::filesystem::path& file, const std::vector<Frame>& frames,
                const std::string& units);
/// A few lines of text.
[[nodiscard]] std::string summary(const std::vector<Frame>& frames, const std::vector<BadFrame>& bad,
                                  const std::string& units);
