// The frames of `sdm sequence`, one after the other.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "notes.h"
#include "progress_line.h"
#include "sequence_checkpoint.h"
#include "sequence_files.h"
#include "sequence_maps.h"
#include "sequence_options.h"
#include "sequence_pair.h"
#include "sequence_report.h"
#include "sequence_temporal.h"

/// What a run of `sdm sequence` takes: read and decided before the first frame.
struct SequenceInput {
  std::array<Body, 2> bodies;
  std::size_t count;                         ///< of frames
  std::array<sdm::AtlasOptions, 2> atlases;  ///< of the bodies
  sdm::MapOptions map;
  Notes notes;  ///< on the bodies
};

class FrameLoop {
 public:
  /// Why process() returns: after the last frame, after an interrupt or at a frame that cannot be used.
  enum class End { complete, interrupted, stopped };

  /// All but `input` must outlive the loop.
  FrameLoop(const SequenceCommand& command, SequenceInput input, Checkpoint& checkpoint, SequenceFiles& files,
            ProgressLine& progress);

  /// Computes all frames that an earlier run has not finished. Throws sdm::Error if the first frame cannot be
  /// used, and sdm::Cancelled if an interrupt leaves no frame that is new.
  [[nodiscard]] End process();
  /// Writes the files of all frames and, unless these are complete, what a later run needs to continue.
  void write(const std::filesystem::path& folder);

  [[nodiscard]] bool complete() const { return checkpoint_.finished() == count_; }
  [[nodiscard]] const Notes& notes() const { return notes_; }
  [[nodiscard]] const std::vector<Frame>& frames() const { return frames_; }
  [[nodiscard]] const std::vector<BadFrame>& bad() const { return bad_; }

 private:
  void repeat(std::size_t index);
  void adopt_finished();
  [[nodiscard]] bool use(std::size_t index);
  [[nodiscard]] bool skip(std::size_t index, const std::string& fault);
  void compute_maps(Frame& frame);

  const SequenceCommand& command_;
  Checkpoint& checkpoint_;
  SequenceFiles& files_;
  ProgressLine& progress_;
  std::size_t count_;
  Notes notes_;
  TemporalRecorder temporal_;
  MovingPair pair_;
  FrameMaps maps_;
  std::vector<Frame> frames_;
  std::vector<BadFrame> bad_;
};
