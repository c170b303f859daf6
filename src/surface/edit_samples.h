// The order of a surface's samples after an edit.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace sdm::surface {

class SurfaceData;

/// Removes the samples of removed faces, one flag for each face, and adds the samples `added`, whose faces
/// are those of map_faces. Of all others, those with indices from `texels_before` on, which was texels()
/// before the edit, get those that their faces have in map_faces now. Packets of 16 samples that lose none
/// stay as they are; the samples of all others and the added ones are distributed anew over these packets,
/// those near each other in space together. Changes nothing if it throws. Cost: a pass over the samples, plus
/// n log n in the samples that are distributed.
void edit_samples(SurfaceData& surface, std::span<const std::uint8_t> removed_faces,
                  std::span<const std::uint32_t> added, std::uint32_t texels_before);

}  // namespace sdm::surface
