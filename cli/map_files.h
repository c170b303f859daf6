// The output files of a map.
#pragma once

#include <sdm/io.h>
#include <sdm/sdm.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "report.h"

/// Which files of a map are written.
struct MapFiles {
  bool views = true;  ///< views.png
  bool exr = true;    ///< map.exr
  bool png = true;    ///< atlas_distance.png, atlas_voronoi.png and atlas_direction.png
  bool glb = true;    ///< model.glb
  /// report.html: written by the commands that offer it, as it contains their report
  bool html = true;
  bool texture = false;                                     ///< distance_texture.png and .json
  bool ply = false, csv = false, npy = false, vtp = false;  ///< vertices.ply, ...

  /// Whether there is a file of the input's vertices.
  [[nodiscard]] bool any_vertices() const { return ply || csv || npy || vtp; }
};

/// Their names, in the order in which they are listed for users.
[[nodiscard]] std::vector<std::string> names(const MapFiles& files);
/// The same, each followed by a space.
[[nodiscard]] std::string listed(const MapFiles& files);

/// --write, which sets `files`; `of_one_input`: also to files of the input's vertices, and to report.html if
/// this build can write it.
void add_write_option(CLI::App& app, MapFiles& files, bool of_one_input);

/// --write of a command with other files: `set` receives the words chosen, which are among `choices` or only
/// "none".
void add_write_option(CLI::App& app, std::vector<std::string> choices,
                      const std::vector<std::string>& by_default, const std::string& help,
                      const std::function<void(const std::vector<std::string>&)>& set);

/// --channels, which sets `layers`; its default is what they are.
void add_channels_option(CLI::App& app, std::vector<std::string>& layers);

/// What map.exr says about itself; `units` may be empty.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> exr_attributes(const Input& on,
                                                                              const Input& to,
                                                                              const sdm::DistanceMap& map,
                                                                              const std::string& units);

/// Writes the files but report.html concurrently. `at_vertices`: the distance at each vertex of the surface's
/// mesh. `other`: the other mesh of the views, or null. `picture`: as given, of the texture; `fixed`: the
/// same by fixed_colors(), of the pictures and the model. `exr`: of map.exr.
void write_map_files(const std::filesystem::path& folder, const MapFiles& files, const sdm::Surface& surface,
                     const sdm::DistanceMap& map, std::span<const float> at_vertices, const sdm::Mesh* other,
                     const sdm::PictureOptions& picture, const sdm::PictureOptions& fixed,
                     const sdm::ExrOptions& exr = {});

/// Writes report.json and, if it is chosen, report.html with it.
void write_report(const std::filesystem::path& folder, const MapFiles& files, const sdm::Surface& surface,
                  const sdm::DistanceMap& map, std::span<const float> at_vertices, const std::string& report,
                  const sdm::HtmlOptions& page);

/// Writes the files of the input's vertices.
void write_vertex_files(const std::filesystem::path& folder, const MapFiles& files,
                        const sdm::FileVertices& vertices, std::span<const float> at_vertices);
