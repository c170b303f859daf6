// The command line of `sdm bake`.
#pragma once

#include <sdm/bake.h>
#include <sdm/baked_geometry.h>
#include <sdm/io.h>
#include <sdm/map.h>
#include <sdm/match.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common_options.h"

/// How LOW is laid out: by its texture coordinates if they are usable, otherwise in charts; or as asked for.
struct BakeLayout {
  std::optional<sdm::AtlasKind> kind{};  ///< nothing: whichever is usable
  sdm::AtlasOptions atlas;               ///< its kind is set by bake_surface()
};

/// What is asked for.
struct BakeSelection {
  std::vector<sdm::BakeChannel> look{};
  std::vector<sdm::GeometryChannel> geometry{};
};

struct BakeCommand : RunOptions {
  std::string high, low, transform_high, transform_low;
  sdm::TessellationOptions tessellation{};
  std::filesystem::path out;
  BakeLayout layout;
  sdm::MapOptions map;
  std::optional<sdm::MatchMethod> match{};  ///< nothing: `facing` if map.facing is given, else `closest`
  std::optional<double> cage{};
  std::optional<BakeSelection> channels{};  ///< nothing: sdm::default_channels()
  std::uint32_t sample_side = 1;            ///< the root of the number of samples of a texel
  sdm::AmbientOcclusionOptions occlusion{};
  sdm::ThicknessMethod thickness = sdm::ThicknessMethod::ball;
  bool page = sdm::can_write_html();
  std::string units;
  sdm::UpAxis up = sdm::UpAxis::y;
};

/// The options set `command`, which must outlive the parsing.
void add_options(CLI::App& app, BakeCommand& command);

/// How points of HIGH are found. Throws CLI::ValidationError for options that exclude each other.
[[nodiscard]] sdm::MatchOptions match_options(const BakeCommand& command);

/// sdm::sample_layout() of the command.
[[nodiscard]] BakeLayout sample_layout(const BakeCommand& command);

/// Throws CLI::ValidationError for more samples than a surface can have.
void check_samples(const BakeCommand& command);
