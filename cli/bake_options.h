// The command line of `sdm bake`.
#pragma once

#include <sdm/bake.h>
#include <sdm/map_files.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>

#include "common_options.h"

struct BakeCommand : RunOptions {
  std::string high, low, transform_high, transform_low;
  sdm::TessellationOptions tessellation{};
  std::filesystem::path out;
  sdm::BakeRequest request;
  bool page = sdm::can_write_html();
  std::string units;
  sdm::UpAxis up = sdm::UpAxis::y;
};

/// The options set `command`, which must outlive the parsing.
void add_options(CLI::App& app, BakeCommand& command);
