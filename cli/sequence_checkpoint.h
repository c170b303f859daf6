// What an interrupted run of `sdm sequence` has finished, and what this one has.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "sequence_state.h"

class Checkpoint {
 public:
  /// `resume`: reads what is left of an interrupted run in the folder, if there is one. Throws sdm::Error if
  /// its options are not these.
  Checkpoint(const std::filesystem::path& folder, const nlohmann::ordered_json& options, bool resume);

  /// Whether a run is continued.
  [[nodiscard]] bool resumes() const { return interrupted_.has_value(); }
  /// The run that is continued. Requires resumes().
  [[nodiscard]] const SequenceState& interrupted() const { return *interrupted_; }
  /// The results of this run so far.
  [[nodiscard]] const SequenceState& state() const { return state_; }
  [[nodiscard]] std::size_t finished() const { return state_.frames.size(); }

  /// Throws sdm::Error if a run is continued and its inputs were others. `meshes`: hashes of the first frames
  /// of the bodies, with the names `inputs`. `count`: of all frames.
  void begin(const std::array<std::uint64_t, 2>& meshes, const std::array<std::string, 2>& inputs,
             std::size_t count);
  void set_resolution(std::uint32_t resolution) { state_.resolution = resolution; }
  /// A frame of this run that is finished, or was skipped.
  void add(SequenceState::Frame frame) { state_.frames.push_back(std::move(frame)); }
  /// Makes the frames of the run that is continued those of this one. Returns its maps over time.
  [[nodiscard]] sdm::TemporalMaps adopt();
  /// Throws sdm::Error if the run that is continued is no longer the one in the folder.
  void check_unchanged() const;
  [[noreturn]] void refuse(const std::string& reason) const { refuse_to_resume(folder_, reason); }

  /// Writes the state of this run to `folder`. Throws sdm::Error.
  void write(const std::filesystem::path& folder, const sdm::TemporalMaps& temporal);

 private:
  [[nodiscard]] std::filesystem::file_time_type written() const;

  std::filesystem::path folder_;
  std::filesystem::file_time_type written_;  // before it was read
  std::optional<SequenceState> interrupted_;
  SequenceState state_;
};
