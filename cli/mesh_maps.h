// The maps of a mesh of `sdm map`: one, or one for each UDIM tile.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "atlas_parts.h"
#include "map_result.h"
#include "output_folder.h"
#include "progress_line.h"

struct MeshMaps {
  std::string role;
  std::vector<AtlasPart> parts;
  std::vector<MapResult> results{};  ///< of each part
  std::optional<MapResult> total{};  ///< of several tiles

  [[nodiscard]] bool is_tiled() const { return parts.front().udim.has_value(); }
  /// The result on the whole mesh.
  [[nodiscard]] MapResult& whole() { return total ? *total : results.front(); }
  [[nodiscard]] const MapResult& whole() const { return total ? *total : results.front(); }
  /// The folder of that result, below the output folder of a mesh.
  [[nodiscard]] std::string folder_of_whole() const;
  /// A report, or an object of the reports of the tiles and of all of them, `total`.
  [[nodiscard]] nlohmann::ordered_json report() const;
};

/// Computes the maps of the mesh of a task, and writes their files.
[[nodiscard]] MeshMaps measure_mesh(MapTask task, OutputFolder& out, ProgressLine& progress);

/// The lines that are printed of the maps of a mesh.
[[nodiscard]] std::string summary(const MeshMaps& maps, const Input& on, const Input& to);
