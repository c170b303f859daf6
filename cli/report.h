// The results of `sdm map`, as JSON and as text. The keys are documented in docs/report.md.
#pragma once

#include <sdm/io.h>
#include <sdm/map_files.h>
#include <sdm/mesh_edit.h>
#include <sdm/sdm.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// How the faces of a file look, as of sdm::MeshFile.
struct InputLook {
  std::vector<sdm::Material> materials{};
  std::vector<sdm::TextureFile> textures{};
  std::vector<std::uint32_t> face_materials{};
  std::vector<sdm::MeshAttribute> attributes{};
};

/// A mesh of the command line, after its transform.
struct Input {
  std::string role;  ///< "o1", "o2", or "mesh" if it is the only one
  std::string file, transform;
  sdm::Mesh mesh;
  std::string xxh3{};                   ///< of the file
  std::optional<sdm::MeshInfo> info{};  ///< once inspected
  std::optional<sdm::WeldReport> weld{};
  std::optional<sdm::IslandReport> islands{};       ///< that were left out
  std::vector<std::uint8_t> island_vertices{};      ///< 1: of these only; empty: none is
  std::optional<sdm::Tessellation> tessellation{};  ///< of CAD
  double deviation = 0;  ///< of CAD: largest_deviation, in units of the mesh as it is placed
  std::vector<sdm::FaceNames> names{};
  std::vector<std::string> notes{};             ///< on the file
  std::optional<sdm::FileVertices> vertices{};  ///< of the file, without the transform, if requested
  InputLook look{};                             ///< if attributes were requested
};

/// Sets input.info, which to_json() needs, unless it is set.
void inspect(Input& input);

/// Reads a mesh and applies its transform. Does not inspect it.
[[nodiscard]] Input load_input(const std::string& role, const std::string& file, const std::string& transform,
                               const sdm::MeshFileOptions& options = {});

/// What is reported of one map.
struct Outcome {
  sdm::Summary summary;
  std::uint32_t resolution = 0, rows = 0;  ///< of the map
  double size = 0;                         ///< of the mesh that is measured: the diagonal of its box
  std::size_t boundary_vertices = 0;       ///< that have no sign, as of sdm::boundary_vertices()
  std::optional<bool> embedded{};          ///< the other mesh does not intersect itself; if it has an inside
  std::optional<sdm::GroupVerdicts> groups{};  ///< if there is a table of tolerances
  std::optional<sdm::GlReport> raster;
  std::optional<sdm::GpuReport> gpu;
  sdm::ReportTimes time;
};

/// The mesh with what inspect() found, for the functions of sdm/map_files.h.
[[nodiscard]] sdm::ReportedMesh reported(const Input& input);
[[nodiscard]] nlohmann::ordered_json to_json(const Input& input);

/// Adds the symmetric Hausdorff distance, the larger one of both directions, to the reports on both meshes.
void add_symmetric_hausdorff(nlohmann::ordered_json& o1, nlohmann::ordered_json& o2);

/// JSON text; drops invalid bytes of file names that are not UTF-8.
[[nodiscard]] std::string to_text(const nlohmann::ordered_json& json);

/// The verdict on all and on the groups, if anything was judged.
[[nodiscard]] std::optional<sdm::Verdict> judged(const sdm::Summary& summary,
                                                 const std::optional<sdm::GroupVerdicts>& groups);
/// The first line of what is printed: what was measured, after the verdict if there is one.
[[nodiscard]] std::string heading(const std::string& title, std::optional<sdm::Verdict> verdict);
/// A line on what distances are to, unless it is the closest point.
[[nodiscard]] std::string measured_line(const sdm::Summary& summary);
/// "inside" or "behind": where distances are negative.
[[nodiscard]] const char* side_word(const sdm::SignUsed& sign);
/// A line on the coverage of O2, if it was measured.
[[nodiscard]] std::string coverage_line(const sdm::Summary& summary);
/// One line for each doubt; the text begins in the given column.
[[nodiscard]] std::string doubt_lines(std::span<const sdm::Doubt> doubts, std::size_t column);
/// The extreme that exceeds the tolerance most, or comes closest to a limit.
[[nodiscard]] std::optional<sdm::Extreme> decisive_extreme(const sdm::Summary& summary);

/// A few lines of text. `on` is the mesh that carries the map, of the distances to `to`.
[[nodiscard]] std::string summary(const Input& on, const Input& to, const Outcome& outcome);
