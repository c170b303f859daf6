// `sdm scene scan`.
#pragma once

#include <cstddef>
#include <filesystem>

/// Writes the part, a made scan of it as a mesh and as a cloud, and what is known about the scan. Throws
/// sdm::Error if the part cannot be read or has no place for a dent.
void write_made_scan(const std::filesystem::path& part, std::size_t triangles,
                     const std::filesystem::path& folder, bool quiet);
