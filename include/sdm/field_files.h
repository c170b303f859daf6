/// Distance fields as files for other programs.
///
/// Threads: the functions may be called concurrently, unless two of them write the same file.
#pragma once

#include <sdm/api.h>
#include <sdm/volume.h>

#include <filesystem>
#include <string>

namespace sdm {

/// The names and extensions of the formats, for messages and help texts.
[[nodiscard]] SDM_API std::string field_format_names();
/// Throws sdm::Error unless the file has the extension of a format (in capitals or not), before there is a
/// field to write.
SDM_API void check_field_format(const std::filesystem::path& file);

/// Writes a field in the format of the file's extension; the file appears whole or not at all. Points without
/// a value are NaN, except in OpenVDB. Throws sdm::Error as check_field_format does, if the arrays of the
/// field do not fit its grid, or if the file cannot be written. Cost: linear.
///
/// .npy  NumPy: distances of shape dims, float32, the first index along x (in memory, x varies fastest). Has
///       neither origin nor spacing.
/// .vti  VTK ImageData, for ParaView: the point data `distance`, and `site` and `site_type` if the field has
///       them; raw appended data.
/// .vdb  OpenVDB: the grid `distance`, float, with a transform from the indices of points to the coordinates
///       of the mesh. Points with a value are active; the others have the maximum distance as their value
///       (the background, also outside of the grid), or, without one, the largest distance. A signed field
///       with a maximum distance of at least the largest spacing is a level set, with the negated maximum
///       distance at points beyond it that are inside O2; OpenVDB's tools for level sets also need cubic
///       cells.
SDM_API void write_field(const std::filesystem::path& file, const DistanceField& field);

}  // namespace sdm
