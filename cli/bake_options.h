// The command line of `sdm bake`.
#pragma once

#include <sdm/bake.h>
#include <sdm/io.h>
#include <sdm/map.h>
#include <sdm/match.h>

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
  std::optional<sdm::MatchMethod> match{};  ///< nothing: `facing` if map.facing is given, else `closest`
  std::optional<double> cage{};
  std::optional<std::vector<sdm::BakeChannel>> channels{};  ///< nothing: those that differ
  bool normal_map = false;                                  ///< besides the channels
  std::string units;
  sdm::UpAxis up = sdm::UpAxis::y;
};

/// The options set `command`, which must outlive the parsing.
void add_options(CLI::App& app, BakeCommand& command);

/// How points of HIGH are found. Throws CLI::ValidationError for options that exclude each other.
[[nodiscard]] sdm::MatchOptions match_options(const BakeCommand& command);

/// The word of a method.
[[nodiscard]] std::string name_of(sdm::MatchMethod method);

/// The channel of tangent-space normals, which is no sdm::BakeChannel.
inline constexpr const char* kNormalMap = "normal";

/// The names of the pictures of all channels.
[[nodiscard]] std::string picture_name(sdm::BakeChannel channel);
