// The atlas of a mesh in a file, so that it is laid out once.
#pragma once

#include <sdm/surface.h>

#include <filesystem>

/// The surface with the atlas from `file`; if there is no such file, lays out the atlas and writes it. Throws
/// sdm::Error with the file's name if it cannot be read or written, or if it belongs to another mesh or to
/// other options. If `file` is empty, only lays out the atlas.
[[nodiscard]] sdm::Surface cached_surface(const sdm::Mesh& mesh, const sdm::AtlasOptions& options,
                                          const std::filesystem::path& file);
