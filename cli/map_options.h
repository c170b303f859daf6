// The command line of `sdm map`.
#pragma once

#include <sdm/io.h>
#include <sdm/sdm.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "align_options.h"
#include "common_options.h"
#include "doubts.h"
#include "group_tolerances.h"
#include "input_pair.h"
#include "map_files.h"
#include "report_fields.h"
#include "unit_options.h"

/// How O1 is laid out.
struct MapLayout {
  sdm::AtlasOptions atlas;
  std::filesystem::path cache;
  sdm::PrecisionOptions fit;  ///< the largest error bound, from which the resolution follows
};

struct MapOutput {
  std::filesystem::path folder;
  MapFiles files;
  std::vector<std::string> layers = sdm::default_channel_layers();
};

struct MapCommand : PairFiles, RunOptions {
  bool both = false;
  UnitOptions file_units;
  std::optional<sdm::IslandLimits> islands{}, islands_o2{};
  AlignCommand align;
  DoubtCommand doubts;
  MapLayout layout;
  std::optional<sdm::AlongOptions> along{};  ///< in place of closest points
  sdm::MapOptions map;                       ///< its engine is created from the next two members
  sdm::EngineInfo engine = sdm::engines().front();
  sdm::GlOptions gl;
  sdm::PictureOptions picture;
  GroupTolerances groups;
  double uncertainty = 0;
  std::vector<double> bands;
  ReportFields fields;
  MapOutput output;
};

/// The options set `command`, which must outlive the parsing.
void add_options(CLI::App& app, MapCommand& command);

/// Throws CLI::ValidationError for options that contradict each other.
void check_combination(const CLI::App& app, const MapCommand& command);
