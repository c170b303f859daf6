// The command line of `sdm sequence`.
#pragma once

#include <sdm/io.h>
#include <sdm/mesh_files.h>
#include <sdm/sdm.h>

#include <CLI/CLI.hpp>
#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "pair_options.h"

/// What is written besides the tables and the maps over time.
struct SequenceOutputs {
  int maps_every = 0;  ///< the number of frames from one written map to the next; 0: none
  bool player = false, animation = false;
  bool temporal = true;  ///< the maps over time

  [[nodiscard]] bool has_maps_of(std::size_t frame) const {
    return maps_every > 0 && frame % static_cast<std::size_t>(maps_every) == 0;
  }
  /// Whether the frames are collected for a file that shows all of them.
  [[nodiscard]] bool collect() const { return player || animation; }
};

struct SequenceCommand {
  PairCommand pair;
  sdm::SequenceOptions reading;
  sdm::AtlasOptions atlas{.resolution = 512};
  double map_precision = 0;  ///< the largest error bound of O1's map; 0: any
  sdm::EngineInfo engine = sdm::engines().front();
  std::filesystem::path out;
  SequenceOutputs outputs;
  sdm::PictureOptions picture;
  bool both = false, keep_going = false, resume = false;
  double uncertainty = 0;
  bool accept_doubts = false;

  /// The number of bodies with distances to the other one, O1 first.
  [[nodiscard]] int measured_bodies() const { return both ? 2 : 1; }
  /// Whether distances are measured in each frame.
  [[nodiscard]] bool measures() const { return outputs.collect() || both || picture.tolerance; }
};

/// The options set `command`, which must outlive the parsing.
void add_options(CLI::App& app, SequenceCommand& command);

/// Throws CLI::ValidationError for options that contradict each other.
void check_combination(const SequenceCommand& command);

/// All that affects the files, except the inputs, by the names of the options.
[[nodiscard]] nlohmann::ordered_json options_json(const SequenceCommand& command);
