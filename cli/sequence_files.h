// The files of `sdm sequence`.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "output_folder.h"
#include "sequence_maps.h"
#include "sequence_options.h"
#include "sequence_pair.h"
#include "sequence_report.h"
#include "src/io/page/player/sequence_player.h"

/// Writes the files of one run. All functions throw sdm::Error if a file cannot be written.
class SequenceFiles {
 public:
  /// The files that are written whatever the frames are.
  [[nodiscard]] static std::vector<std::filesystem::path> planned(const SequenceOutputs& outputs);

  /// `first`: the bodies in their first frames. `command` and `out` must outlive the files.
  SequenceFiles(const SequenceCommand& command, OutputFolder& out, const std::array<sdm::Mesh, 2>& first);

  /// Sets the checksums of both inputs' files, which player.html states.
  void set_checksums(std::array<std::string, 2> xxh3) { xxh3_ = std::move(xxh3); }
  /// Adds a line to frames.jsonl, and with --json to the standard output.
  void add_line(const nlohmann::ordered_json& json);
  /// Writes all maps of a frame or, if it throws, none.
  void write_maps(std::size_t frame, const MovingPair& pair, const FrameMaps& maps);
  /// Collects a frame for the files that show all frames.
  void collect(std::size_t frame, const MovingPair& pair);

  /// Writes the files of all frames. `maps`: of any frame of the pair, or none yet; left with other values.
  void finish(const std::vector<Frame>& frames, const sdm::TemporalMaps& temporal, const MovingPair& pair,
              FrameMaps& maps);
  /// The names of the files, separated by blanks. After finish().
  [[nodiscard]] const std::string& listed() const { return listed_; }
  /// What the user should know about the files. After finish().
  [[nodiscard]] std::vector<std::string> notes() const;

 private:
  void write_temporal(const sdm::TemporalMaps& temporal, const MovingPair& pair, FrameMaps& maps) const;
  void write_collected(const std::vector<Frame>& frames);

  const SequenceCommand& command_;
  OutputFolder& out_;
  std::filesystem::path folder_;  // where `out` stages files
  std::ofstream lines_;
  std::optional<sdm::SequencePlayer> player_;
  std::size_t animated_frames_ = 0;  // in animation.glb
  std::array<std::string, 2> xxh3_;  // of both inputs
  std::string listed_;
};
