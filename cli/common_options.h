// Options of several commands.
#pragma once

#include <sdm/io.h>
#include <sdm/surface.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

// Parsing sets the given targets, which must outlive it.

/// Returns -o, which is required.
CLI::Option* add_output_option(CLI::App& app, std::filesystem::path& folder);
void add_transform_option(CLI::App& app, const std::string& name, const std::string& mesh,
                          std::string& steps);
/// Returns --resolution; `maps` names the maps in the help text.
CLI::Option* add_resolution_option(CLI::App& app, sdm::AtlasOptions& atlas,
                                   const std::string& maps = "the map");
/// `mesh` names the mesh that is parametrised.
void add_layout_options(CLI::App& app, sdm::AtlasOptions& atlas, const std::string& mesh);
void add_picture_options(CLI::App& app, sdm::PictureOptions& picture, std::vector<double>& range);
/// --exact and --units of commands that print proximity.
void add_proximity_options(CLI::App& app, bool& exact, std::string& units);
/// --threads, --json and --quiet; `json_prints` describes the JSON for the help text.
void add_run_options(CLI::App& app, unsigned& threads, bool& json, bool& quiet,
                     const std::string& json_prints);

/// Throws CLI::ValidationError unless the range is empty or increasing.
void check_range(const std::vector<double>& range);
