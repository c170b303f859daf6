// The results of `sdm map`, as JSON and as text. The keys are documented in docs/report.md.
#pragma once

#include <sdm/io.h>
#include <sdm/sdm.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "map_numbers.h"

/// A mesh of the command line, after its transform.
struct Input {
  std::string role;  ///< "o1", "o2", or "mesh" if it is the only one
  std::string file, transform;
  sdm::Mesh mesh;
  std::optional<sdm::MeshInfo> info{};  ///< once inspected
  std::vector<sdm::FaceNames> names{};
  std::vector<std::string> notes{};             ///< on the file
  std::optional<sdm::FileVertices> vertices{};  ///< of the file, without the transform, if requested
};

/// Sets input.info, which to_json() needs, unless it is set.
void inspect(Input& input);

/// Reads a mesh and applies its transform. Does not inspect it.
[[nodiscard]] Input load_input(const std::string& role, const std::string& file, const std::string& transform,
                               const sdm::MeshFileOptions& options = {});

/// Wall-clock times in milliseconds. Overlapping steps are each counted in full.
struct Times {
  double import = 0, atlas = 0, sites = 0, map = 0, output = 0, total = 0;
};

/// The numbers of one map.
struct Outcome {
  sdm::DistanceStatistics distance;
  sdm::Extremes extremes;
  sdm::SignUsed sign;
  std::size_t beyond_max_distance = 0;
  std::size_t boundary_texels = 0;  ///< whose closest point lies on the boundary of an open mesh
  double error_bound = 0;
  double accuracy = 0;                     ///< of the engine; infinite if unknown
  double max_distance = 0;                 ///< infinite if there is no limit
  std::uint32_t resolution = 0, rows = 0;  ///< of the map
  double size = 0;                         ///< of the mesh that is measured: the diagonal of its box
  std::optional<bool> embedded{};          ///< the other mesh does not intersect itself; if it has an inside
  std::vector<std::string> notes;          ///< what the user probably did not intend
  std::optional<sdm::ToleranceVerdict> tolerance;
  MapNumbers numbers;
  std::optional<sdm::GlReport> raster;
  Times time;
};

[[nodiscard]] nlohmann::ordered_json to_json(const Input& input);
[[nodiscard]] nlohmann::ordered_json to_json(const sdm::Surface& surface);
[[nodiscard]] const char* sign_name(sdm::SignMethod method);
/// The colour scale of the pictures: `fixed` by fixed_colors() from what was `given`.
[[nodiscard]] nlohmann::ordered_json colors_json(const sdm::PictureOptions& fixed,
                                                 const sdm::PictureOptions& given);
/// Of an outcome what also several maps together have: without histogram, bands, parts, notes and times.
[[nodiscard]] nlohmann::ordered_json measures_json(const Outcome& outcome);
[[nodiscard]] nlohmann::ordered_json to_json(const Outcome& outcome);

/// Bounds on the largest distance of all points of the mesh with the map to the other one, inside or outside,
/// from the samples and vertices and the error bound: `lower`, `upper`, `kind`, and `point`, which is `lower`
/// away. `upper` is null if a texel is farther than the maximum distance.
[[nodiscard]] nlohmann::ordered_json one_sided_hausdorff(const Outcome& outcome);

/// Of two reports, the larger one of either direction; added to both.
void add_symmetric_hausdorff(nlohmann::ordered_json& o1, nlohmann::ordered_json& o2);

/// JSON text; drops invalid bytes of file names that are not UTF-8.
[[nodiscard]] std::string to_text(const nlohmann::ordered_json& json);

/// A few lines of text. `on` is the mesh that carries the map, of the distances to `to`.
[[nodiscard]] std::string summary(const Input& on, const Input& to, const Outcome& outcome,
                                  const std::string& units);
