// Options shared by several commands.
#pragma once

#include <sdm/engine.h>
#include <sdm/gl.h>
#include <sdm/map_files.h>
#include <sdm/surface.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

// Parsing sets the given targets, which must outlive it.

/// Returns -o, which is required.
CLI::Option* add_output_option(CLI::App& app, std::filesystem::path& folder);
void add_transform_option(CLI::App& app, const std::string& name, const std::string& mesh,
                          std::string& steps);
/// Returns --resolution of square maps; `maps` describes them in the help text.
CLI::Option* add_side_option(CLI::App& app, sdm::AtlasOptions& atlas, const std::string& maps);
/// Returns --resolution, N or WxH; check_layout() checks whether the atlas can have that shape.
CLI::Option* add_resolution_option(CLI::App& app, sdm::AtlasOptions& atlas,
                                   const std::string& maps = "the map");
CLI::Option* add_resolution_option(CLI::App& app, std::uint32_t& resolution,
                                   std::optional<std::uint32_t>& rows, const std::string& maps);
/// All of an atlas but its resolution.
void add_layout_options(CLI::App& app, sdm::AtlasOptions& atlas);
/// Throws CLI::ValidationError for a map that is not square unless the atlas is that of the mesh.
void check_layout(const sdm::AtlasOptions& atlas);
/// --engine.
void add_engine_option(CLI::App& app, sdm::EngineInfo& engine);
/// Makes the engine of that option. Throws sdm::Error if there is none on this computer for maps as large as
/// those of the atlas.
[[nodiscard]] std::shared_ptr<const sdm::Engine> make_engine(const sdm::EngineInfo& engine,
                                                             const sdm::GlOptions& gl,
                                                             const sdm::AtlasOptions& atlas);
/// --colormap and --range.
void add_color_options(CLI::App& app, sdm::PictureOptions& picture);
/// --colormap, --range, --picture-size, --units, --up and --unlit.
void add_picture_options(CLI::App& app, sdm::PictureOptions& picture);
/// --units, for printed and drawn values.
void add_units_option(CLI::App& app, std::string& units);
/// --up; `text`: its help, with the files that it applies to.
void add_up_option(CLI::App& app, sdm::UpAxis& up, const char* text);
void add_tolerance_option(CLI::App& app, std::optional<sdm::Tolerance>& tolerance);
/// How a command runs and what it prints.
struct RunOptions {
  unsigned threads = 0;  ///< 0: all cores
  bool json = false, quiet = false;
};

/// Adds --threads, --quiet and --json; `json_prints` describes the JSON in the help text. Without a
/// description, there is no --json.
void add_run_options(CLI::App& app, RunOptions& run, const std::string& json_prints = {});

/// Limits the threads of this process to `count`, 0: all cores. Never lifted: oneTBB would start threads
/// then, which fails if memory is short, although the results are complete.
void limit_threads(unsigned count);
