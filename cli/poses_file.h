// Poses of bodies from a text file.
#pragma once

#include <sdm/mesh_edit.h>

#include <filesystem>
#include <vector>

/// Reads a pose from each line of a file, of `count` lines: 7 numbers, the translation x y z and the
/// quaternion w x y z; or 12 or 16, the first rows or all of a 4×4 matrix, row by row. Numbers are separated
/// by spaces or commas; empty lines, and what follows a '#', are ignored. Throws sdm::Error, which names the
/// file and the line.
[[nodiscard]] std::vector<sdm::Transform> read_poses(const std::filesystem::path& file, std::size_t count);
