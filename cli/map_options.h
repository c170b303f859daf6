// The command line of `sdm map`.
#pragma once

#include <sdm/io.h>
#include <sdm/sdm.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "alignment.h"
#include "map_files.h"

struct MapCommand {
  std::string o1, o2, transform_o1, transform_o2;
  std::filesystem::path out, atlas_cache;
  AlignCommand align;
  sdm::AtlasOptions atlas;
  sdm::MapOptions map;  ///< its engine is created from the next two members
  sdm::EngineInfo engine = sdm::engines().front();
  sdm::GlOptions gl;
  sdm::PictureOptions picture;
  MapFiles files;
  std::vector<std::string> layers = sdm::default_channel_layers();
  std::vector<double> bands;
  std::optional<double> precision;
  unsigned threads = 0;
  bool both = false, json = false, quiet = false;
};

/// The options set `command`, which must outlive the parsing.
void add_options(CLI::App& app, MapCommand& command);

/// Throws CLI::ValidationError for options that contradict each other.
void check_combination(const CLI::App& app, const MapCommand& command);
