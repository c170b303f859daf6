// The map of a mesh by itself, of `sdm self` and `sdm thickness`.
#pragma once

#include <sdm/map.h>
#include <sdm/map_files.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common_options.h"
#include "map_files.h"
#include "part_file.h"
#include "report.h"
#include "report_fields.h"
#include "src/core/stopwatch.h"

/// The options of every such command.
struct PartMapCommand : RunOptions {
  PartFile part;
  std::filesystem::path out;
  sdm::AtlasOptions atlas;
  sdm::PictureOptions picture;
  MapFiles files;
  std::vector<std::string> layers = sdm::default_channel_layers();
  ReportFields fields;
};

/// Adds those options that do not depend on what is measured.
void add_part_map_options(CLI::App& app, PartMapCommand& command);
/// Throws CLI::ValidationError for options that contradict each other.
void check_part_map(const PartMapCommand& command);

/// A map and what it is of; times are those since the atlas began.
struct PartMap {
  /// Makes the atlas.
  PartMap(const Input& input, double import_ms, const sdm::AtlasOptions& atlas);
  const Input& input;
  sdm::Stopwatch total, watch;  ///< of all, of the step
  sdm::Surface surface;
  sdm::DistanceMap map{};
  std::vector<float> at_vertices{};
  sdm::ReportTimes times{};
};

/// What a command adds to the outputs of all such maps.
struct PartMapOutputs {
  std::function<void(const sdm::ExrOptions& exr)> write = [](auto&) {};  ///< further files
  std::function<void(nlohmann::ordered_json& report)> extend = [](auto&) {};
  sdm::HtmlOptions page{};
};

/// Completes the notes of the summary, writes all files into `folder`, and returns the report. `sites`: of
/// the map.
[[nodiscard]] nlohmann::ordered_json write_part_map(const PartMapCommand& command, PartMap& part,
                                                    const sdm::Sites& sites, sdm::Summary& summary,
                                                    const std::filesystem::path& folder,
                                                    const PartMapOutputs& outputs);
