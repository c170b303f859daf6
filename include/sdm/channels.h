/// The table of channels: what a map has at each texel, a row for each array.
///
/// map.exr and the choice of its layers, the arrays of the Python package, the values that report.html shows
/// and the columns of the files of vertices are made from this table. docs/design/house.md describes how to
/// add a row.
///
/// Threads: the functions may be called concurrently.
#pragma once

#include <sdm/api.h>
#include <sdm/map.h>
#include <sdm/sites.h>
#include <sdm/surface.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace sdm {

namespace map {
class TexelBlock;
}

/// The type of a channel's numbers. In map.exr 64-bit floats have 32 bits, and whole numbers too.
enum class ChannelType : std::uint8_t { float32, float64, uint32, uint8 };

/// A row of the table.
struct Channel {
  const char* name;   ///< of the array in Python and of the column in files of vertices
  const char* layer;  ///< of map.exr, to be chosen there; empty: in all that have what the row needs
  std::array<const char*, 3> planes{};  ///< the names of its components in map.exr; null: no more of them
  const char* description;              ///< a phrase without a full stop
  bool is_length = false;               ///< in the units of the meshes; otherwise without a unit
  bool on_request = false;              ///< in map.exr only if its layer is asked for
  bool in_python = true;                ///< an array of the Python package
  bool on_page = false;                 ///< in report.html, for the texel under the cursor
  bool at_vertices = false;             ///< in the files of vertices; reads nothing but distances
  bool needs_shape = false;             ///< positions of the surface
  bool needs_sites = false;
  bool needs_boundary = false;

  // What follows from how the row is read:
  ChannelType type = ChannelType::float32;
  const char* none = "";  ///< the value of a texel without one, in words
  void (*read)(const map::TexelBlock& block, std::byte* values) = nullptr;
  /// The memory of a channel that maps store; null for one that is computed.
  std::span<const std::byte> (*stored)(const DistanceMap& map) = nullptr;

  /// The number of components of a value, 1 to 3.
  [[nodiscard]] std::size_t components() const {
    std::size_t count = 0;
    while (count < planes.size() && planes[count] != nullptr) ++count;
    return count;
  }
};

/// The table, in the order in which it is listed for users.
[[nodiscard]] SDM_API std::span<const Channel> channels();

/// The bytes of one number of this type.
[[nodiscard]] SDM_API std::size_t size_of(ChannelType type);
/// The name of the type in NumPy, such as "float32".
[[nodiscard]] SDM_API const char* name_of(ChannelType type);

/// The layers of map.exr, in the order of the table.
[[nodiscard]] SDM_API std::vector<std::string> channel_layers();
/// Those that map.exr has unless others are chosen.
[[nodiscard]] SDM_API std::vector<std::string> default_channel_layers();

/// What channels are read from.
struct ChannelSource {
  const DistanceMap* map = nullptr;
  const Surface* surface = nullptr;          ///< on which the map was computed; not for stored channels
  const Sites* sites = nullptr;              ///< of the map, for rows that need them
  std::span<const std::uint8_t> boundary{};  ///< of boundary_mask(), for rows that need it
};

/// Returns the values of each of `channels` at texels, those of one texel together. `texels`: owned ones, or
/// kNone for one without a value; number i stands for texel first + i, which may repeat another one's values.
/// Throws sdm::Error if the source lacks what a channel needs. Cost: constant per value.
[[nodiscard]] SDM_API std::vector<std::vector<std::byte>> read_channels(std::span<const Channel> channels,
                                                                        const ChannelSource& source,
                                                                        std::span<const std::uint32_t> texels,
                                                                        std::uint32_t first = 0);

}  // namespace sdm
