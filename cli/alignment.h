// --align: O1 is moved onto O2 before distances are measured.
#pragma once

#include <sdm/align.h>
#include <sdm/unit_check.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

struct AlignCommand {
  bool on = false;
  std::string from = "none";  ///< "none", "pca" or the name of a matrix file
  bool judged = false;        ///< a verdict depends on it: whether O1 fits in another unit is looked at too
};

/// Adds --align and --align-from.
void add_align_options(CLI::App& app, AlignCommand& command);

/// A finished alignment, with what is printed about it.
struct AlignOutcome {
  sdm::Alignment alignment;
  std::string from;
  double size = 0;  ///< the diagonal of O2
  double time_ms = 0;
  std::optional<sdm::OtherUnit> other_unit{};
};

/// Aligns a mesh to O2, and moves it.
[[nodiscard]] AlignOutcome align_mesh(sdm::Mesh& o1, const sdm::Sites& o2, const AlignCommand& command,
                                      const sdm::Progress& progress);
/// Aligns points to O2, and leaves them as they are. `normals`: as for sdm::align.
[[nodiscard]] AlignOutcome align_points(std::span<const sdm::Vec3> points, std::span<const sdm::Vec3> normals,
                                        const sdm::Sites& o2, const AlignCommand& command,
                                        const sdm::Progress& progress);

/// The object of alignment.json, and of the key `alignment` of reports. sdm::read_matrix reads both.
[[nodiscard]] nlohmann::ordered_json to_json(const AlignOutcome& outcome);
/// One line.
[[nodiscard]] std::string summary(const AlignOutcome& outcome, const std::string& units);
/// What may be wrong with the alignment.
[[nodiscard]] std::vector<std::string> notes(const AlignOutcome& outcome);
