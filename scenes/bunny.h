// The Stanford bunny.
#pragma once

#include <sdm/mesh.h>

#include <filesystem>

namespace sdm::scenes {

/// Reads the mesh that stands for a bunny: `file` or, if it is empty, the bunny of Debian's glmark2-data (69k
/// triangles). Throws sdm::Error if there is none or it cannot be read.
[[nodiscard]] Mesh read_bunny(const std::filesystem::path& file = {});

}  // namespace sdm::scenes
