// --align: O1 is moved onto O2 before distances are measured.
#pragma once

#include <sdm/align.h>
#include <sdm/doubts.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "align_options.h"
#include "report.h"

/// A finished alignment, with what is printed about it.
struct AlignOutcome {
  sdm::Alignment alignment;
  AlignCommand command;
  double size = 0;  ///< the diagonal of O2
  double time_ms = 0;
  nlohmann::ordered_json settings{};  ///< the options of align()
  std::optional<sdm::OtherUnit> other_unit{};
  std::optional<sdm::MirroredFit> mirrored{};
  std::optional<sdm::OtherScale> scale{};
  std::string group_kind{};                ///< of the groups of O2 that have residuals, and their names
  std::vector<std::string> group_names{};  ///< in the order of Alignment::groups; none if there is only one
};

/// Aligns a mesh to O2, whose sites are given, and moves it.
[[nodiscard]] AlignOutcome align_mesh(sdm::Mesh& o1, const sdm::Sites& sites, const Input& o2,
                                      const AlignCommand& command, const sdm::Progress& progress);
/// Aligns points to O2, and leaves them as they are. `normals`: as for sdm::align.
[[nodiscard]] AlignOutcome align_points(std::span<const sdm::Vec3> points, std::span<const sdm::Vec3> normals,
                                        const sdm::Sites& sites, const Input& o2, const AlignCommand& command,
                                        const sdm::Progress& progress);

/// The doubts that it leaves.
[[nodiscard]] std::vector<sdm::Doubt> doubts_of(const AlignOutcome& outcome);

/// The object of alignment.json, and of the key `alignment` of reports. sdm::read_matrix reads both.
[[nodiscard]] nlohmann::ordered_json to_json(const AlignOutcome& outcome, const std::string& units);
/// What was done and what is left between the surfaces, in lines.
[[nodiscard]] std::string summary(const AlignOutcome& outcome, const std::string& units);
/// What may be wrong with the alignment.
[[nodiscard]] std::vector<std::string> notes(const AlignOutcome& outcome);
