/// Statistics over time of the maps of one surface.
///
/// Threads: const functions of an object may be called concurrently; nothing else may run beside the others.
#pragma once

#include <sdm/api.h>
#include <sdm/map.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sdm {

/// The minimum, maximum and mean distance of every texel of an atlas over the added maps; faces without a
/// texel have none. NaN where no
/// face owns the texel, where another face or none owned it in an earlier map, or where it
/// was beyond the maximum distance in one of the maps. Self maps mark the
/// latter by +∞ instead: the minimum is then that over the other maps.
class SDM_API TemporalMaps {
 public:
  /// What a later process needs in order to continue.
  struct State {
    std::size_t maps = 0;
    std::uint32_t resolution = 0;
    std::vector<float> least{}, largest{};  ///< of whole rows of texels, none before the first map
    std::vector<double> sum{};              ///< of the distances, likewise
  };

  TemporalMaps() = default;
  /// Continues from an earlier state: the results are bit for bit those without the interruption. Throws
  /// sdm::Error if the sizes do not match.
  explicit TemporalMaps(State state);

  /// Adds a map. Throws sdm::Error, and changes nothing, if its size differs from that of earlier maps or
  /// there is not enough memory. Cost: O(n) in texels, all cores.
  void add(const DistanceMap& map);

  /// Follows an edit of the surface: texels whose face stays keep their statistics, all others become NaN for
  /// good. `before`: Surface::texel_faces() before Surface::edit. Throws sdm::Error, and changes
  /// nothing, if the sizes do not match or there is not enough memory. Cost: O(n) in texels.
  void follow_edit(std::span<const std::uint32_t> before, const Surface& edited);

  /// The number of maps added.
  [[nodiscard]] std::size_t maps() const { return state_.maps; }
  /// Texels per row; 0 before the first map.
  [[nodiscard]] std::uint32_t resolution() const { return state_.resolution; }
  /// The minimum of each texel, in rows.
  [[nodiscard]] std::span<const float> least() const { return state_.least; }
  /// The maximum of each texel.
  [[nodiscard]] std::span<const float> largest() const { return state_.largest; }
  /// Cost: O(n) in texels.
  [[nodiscard]] std::vector<float> mean() const;
  /// What a later process needs in order to continue.
  [[nodiscard]] const State& state() const { return state_; }

 private:
  State state_;
};

}  // namespace sdm
