// An atlas as a sequence of bytes.
#pragma once

#include <sdm/surface.h>

#include <cstdint>
#include <span>
#include <vector>

namespace sdm::surface {

class SurfaceData;

/// The atlas, with checksums of itself and of the mesh. Cost: linear.
[[nodiscard]] std::vector<std::uint8_t> store_atlas(const SurfaceData& surface);

/// Sets all members that describe the atlas; `surface` has its mesh and the options' kind and resolution.
/// Throws sdm::Error as Surface's constructor from a stored atlas does. Cost: linear.
void restore_atlas(SurfaceData& surface, const AtlasOptions& options, std::span<const std::uint8_t> bytes);

/// The options that restore_atlas() requires. Throws sdm::Error if the bytes are not a stored atlas.
[[nodiscard]] AtlasOptions stored_options(std::span<const std::uint8_t> bytes);

}  // namespace sdm::surface
