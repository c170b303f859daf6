// The command line of `sdm bake`.
#pragma once

#include <sdm/bake.h>
#include <sdm/io.h>
#include <sdm/map.h>

#include <CLI/CLI.hpp>
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

struct BakeCommand : RunOptions {
  std::string high, low, transform_high, transform_low;
  sdm::TessellationOptions tessellation{};
  std::filesystem::path out;
  BakeLayout layout;
  sdm::MapOptions map;
  std::optional<std::vector<sdm::BakeChannel>> channels{};  ///< nothing: those that differ
  std::string units;
  sdm::UpAxis up = sdm::UpAxis::y;
};

/// The options set `command`, which must outlive the parsing.
void add_options(CLI::App& app, BakeCommand& command);

/// The names of the pictures of all channels.
[[nodiscard]] std::string picture_name(sdm::BakeChannel channel);
