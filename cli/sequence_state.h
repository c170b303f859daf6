// What `sdm sequence` stores of an incomplete run, for --resume.
#pragma once

#include <sdm/mesh.h>
#include <sdm/statistics.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// A hash of positions, to recognise inputs that have changed. Cost: O(n).
[[nodiscard]] std::uint64_t hash_of(std::span<const sdm::Vec3> positions);
/// A hash of positions and triangles.
[[nodiscard]] std::uint64_t hash_of(const sdm::Mesh& mesh);

/// Hashes of the positions that were read of a frame; none of a body that is at rest, or was not read.
using FrameHash = std::array<std::optional<std::uint64_t>, 2>;

// NOLINTNEXTLINE(bugprone-exception-escape): moving JSON does not throw
struct SequenceState {
  static constexpr const char* kFile = "resume.state";

  /// A frame that is finished, or was skipped.
  struct Frame {
    nlohmann::ordered_json line;  ///< of frames.jsonl
    FrameHash hash{};
  };

  nlohmann::ordered_json options{};       ///< all that affect results, by their names
  std::array<std::uint64_t, 2> meshes{};  ///< hashes of the first frame of each body
  std::uint32_t resolution = 0;           ///< of the first layout of O1
  std::vector<Frame> frames{};            ///< from frame 0 on
  sdm::TemporalMaps temporal{};           ///< of `frames`

  /// Throws sdm::Error if the file cannot be written.
  void write(const std::filesystem::path& file) const;
  /// Throws sdm::Error if the file is damaged.
  [[nodiscard]] static SequenceState read(const std::filesystem::path& file);
};

/// The state of the incomplete run in the folder; none if there is no such run. Throws sdm::Error if its
/// options are not these.
[[nodiscard]] std::optional<SequenceState> incomplete_run(const std::filesystem::path& folder,
                                                          const nlohmann::ordered_json& options);
/// Throws sdm::Error.
[[noreturn]] void refuse_to_resume(const std::filesystem::path& folder, const std::string& reason);
