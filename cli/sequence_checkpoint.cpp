#include "sequence_checkpoint.h"

#include <fmt/format.h>

#include <system_error>
#include <utility>

Checkpoint::Checkpoint(const std::filesystem::path& folder, const nlohmann::ordered_json& options,
                       bool resume)
    : folder_(folder),
      written_(written()),
      interrupted_(resume ? incomplete_run(folder, options) : std::nullopt),
      state_{.options = options} {}

void Checkpoint::begin(const std::array<std::uint64_t, 2>& meshes, const std::array<std::string, 2>& inputs,
                       std::size_t count) {
  state_.meshes = meshes;
  if (!resumes()) return;
  for (int b = 0; b < 2; ++b)
    if (interrupted_->meshes[b] != meshes[b])
      refuse(fmt::format("{} is not the mesh of the interrupted run", inputs[b]));
  if (const std::size_t kept = interrupted_->frames.size(); kept > count)
    refuse(fmt::format("the inputs have {} frames and the interrupted run has finished {}", count, kept));
}

sdm::TemporalMaps Checkpoint::adopt() {
  state_.frames = std::move(interrupted_->frames);
  return std::move(interrupted_->temporal);
}

void Checkpoint::check_unchanged() const {
  if (resumes() && written() != written_) refuse("another run has changed it meanwhile");
}

void Checkpoint::write(const std::filesystem::path& folder, const sdm::TemporalMaps& temporal) {
  state_.temporal = temporal;
  state_.write(folder / SequenceState::kFile);
}

std::filesystem::file_time_type Checkpoint::written() const {
  std::error_code missing;
  return std::filesystem::last_write_time(folder_ / SequenceState::kFile, missing);
}
