// The results of `sdm points`, as JSON and as text. The keys are documented in docs/alignment.md.
#pragma once

#include <sdm/points.h>
#include <sdm/sdm.h>

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "alignment.h"
#include "common_options.h"
#include "doubts.h"
#include "exit_codes.h"
#include "group_tolerances.h"
#include "report.h"
#include "report_fields.h"
#include "unit_options.h"

/// The options of the command.
struct PointsCommand : RunOptions {
  std::string cloud, o2, transform_o1, transform_o2;
  std::filesystem::path out;
  UnitOptions file_units;
  std::optional<sdm::WeldOptions> weld{};  ///< of O2
  sdm::TessellationOptions tessellation{};
  AlignCommand align;
  DoubtCommand doubts;
  GroupTolerances groups;
  double uncertainty = 0;
  std::uint64_t island_points = 0;  ///< clusters of less are islands; 0: there are none
  std::optional<sdm::IslandLimits> islands_o2{};
  sdm::MapOptions map;
  std::optional<sdm::AlongOptions> along{};
  sdm::PictureOptions picture;
  sdm::TextDialect text;
  ReportFields fields;
  bool ply = true, html = sdm::can_write_html();
};

/// What is found.
struct PointsOutcome {
  sdm::PointDistances found;
  sdm::Summary summary;
  std::optional<sdm::CoverageMap> coverage;
  std::optional<AlignOutcome> aligned;
  double import_ms = 0, align_ms = 0, points_ms = 0;

  [[nodiscard]] ExitCode code() const {
    return exit_code(judged(summary, found.groups).value_or(sdm::Verdict::pass));
  }
};

/// The object of report.json.
[[nodiscard]] nlohmann::ordered_json report_of(const PointsCommand& command, const Input& o2,
                                               const PointsOutcome& outcome);
/// What is printed, up to the files.
[[nodiscard]] std::string text_of(const PointsCommand& command, const PointsOutcome& outcome);
