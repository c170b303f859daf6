// Placements of meshes given as text, such as "fit,rotate:0:90:0,translate:0.8:0:0".
#pragma once

#include <sdm/mesh.h>
#include <sdm/mesh_edit.h>

#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace sdm::io {

/// One step of a placement.
struct PlacementStep {
  enum class Kind {
    fit,        ///< scale and move so that the longest side of the bounds is 1, centred at the origin
    scale,      ///< multiply by value[0], about the origin
    rotate,     ///< rotate by value degrees about the X, then Y, then Z axis, right-handed
    translate,  ///< add value
    file,       ///< apply the matrix of a file, as of read_matrix
    matrix,     ///< apply the matrix
  };
  Kind kind;
  Vec3 value{};
  std::filesystem::path file{};
  Transform matrix{};
};

/// Parses steps separated by commas: fit, scale:S, rotate:X:Y:Z, translate:X:Y:Z, matrix:FILE. An empty text
/// has no steps. Throws sdm::Error that names the invalid step. Files are not read; their names contain no
/// comma.
[[nodiscard]] std::vector<PlacementStep> parse_placement(std::string_view text);

/// Applies the steps in order, each with its own rounding. Throws sdm::Error if a coordinate becomes
/// infinite, and as read_matrix does. Cost: linear.
void place(Mesh& mesh, const std::vector<PlacementStep>& steps);
/// The same for points. Also throws sdm::Error for `fit`, which needs a mesh.
void place(std::span<Vec3> points, const std::vector<PlacementStep>& steps);

/// Returns the steps as one map, with its rounding. Throws sdm::Error for `fit`, and as read_matrix does.
[[nodiscard]] Transform transform_of(const std::vector<PlacementStep>& steps);

/// Returns the steps with each `fit` replaced by its translation and scale for this mesh, and each file by
/// its matrix, so that all frames of a sequence are placed like the first. Throws as place does.
[[nodiscard]] std::vector<PlacementStep> without_fit(Mesh mesh, const std::vector<PlacementStep>& steps);

}  // namespace sdm::io
