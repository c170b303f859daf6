/// Parts of a surface distance map: for programs that divide a map among processes, or into steps between
/// which they do something else.
///
/// Threads: as of sdm/map.h.
#pragma once

#include <sdm/api.h>
#include <sdm/map.h>
#include <sdm/sites.h>
#include <sdm/surface.h>

#include <cstddef>

namespace sdm {

/// A range of the samples of a surface, by their places in Surface::sample_texels().
struct SampleRange {
  std::size_t first = 0, count = 0;
};

/// Returns the number of samples that are searched together: ranges for compute_samples() begin and end at
/// its multiples, or at the end of the samples. A power of four, at most 65,536 and mostly between a 32nd and
/// a 128th of the samples. Cost: O(1).
[[nodiscard]] SDM_API std::size_t sample_range_grain(const Surface& surface);

/// Returns a map of the surface, without a value at any sample. Throws sdm::Error if there
/// is not enough memory. Cost: linear.
[[nodiscard]] SDM_API DistanceMap empty_map(const Surface& surface);

/// Computes the values of some samples and stores them; the others keep theirs. Once
/// this was called for ranges that cover all samples, in any order, with the same arguments otherwise, the
/// arrays and the sign of the map are those of compute_map() to the bit; beyond_max_distance and
/// without_match count the samples of this range. Throws sdm::Error as compute_map() does, if `map` has
/// another size than the atlas, for ranges other than those of sample_range_grain(), and for engines that
/// compute whole maps only. Cost: as compute_map(), by the samples of the range, and with options.facing
/// linear in the faces of the surface.
SDM_API void compute_samples(const Surface& surface, const Sites& sites, const MapOptions& options,
                             const SampleRange& range, DistanceMap& map);

}  // namespace sdm
