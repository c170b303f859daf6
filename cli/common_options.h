// Options of commands that write maps.
#pragma once

#include <sdm/io.h>
#include <sdm/surface.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

// Each sets its targets, which must outlive the parsing.

void add_output_option(CLI::App& app, std::filesystem::path& folder);
void add_transform_option(CLI::App& app, const std::string& name, const std::string& mesh,
                          std::string& steps);
/// Returns --resolution. `mesh` is what is laid out.
CLI::Option* add_resolution_option(CLI::App& app, sdm::AtlasOptions& atlas);
void add_layout_options(CLI::App& app, sdm::AtlasOptions& atlas, const std::string& mesh);
void add_picture_options(CLI::App& app, sdm::PictureOptions& picture, std::vector<double>& range);
void add_run_options(CLI::App& app, unsigned& threads, bool& json, bool& quiet);

/// Throws CLI::ValidationError for a range that is none.
void check_range(const std::vector<double>& range);
