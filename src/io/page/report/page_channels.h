// The channels of a map that report.html shows.
#pragma once

#include <sdm/map.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

namespace sdm::io {

/// The rows of the table of channels that are on the page, read as 32-bit numbers: a plane for each
/// component. Floats keep their order (page_numbers.h); 0xFFFFFFFF stands for no value.
class PageChannels {
 public:
  PageChannels();

  [[nodiscard]] std::span<const Channel> channels() const { return channels_; }
  [[nodiscard]] std::size_t planes() const { return planes_; }

  /// Reads texels, kNone for free ones, to the places from `first` on of all planes.
  void read(const ChannelSource& source, std::span<const std::uint32_t> texels, std::size_t first,
            std::span<std::vector<std::uint32_t>> planes) const;

 private:
  std::vector<Channel> channels_;
  std::size_t planes_ = 0;
};

/// Whether the page draws the channel in colours: the distance. The others are listed in the JSON of the map.
[[nodiscard]] bool is_drawn(const Channel& channel);

/// The name of the packed array of component k.
[[nodiscard]] std::string array_name(const Channel& channel, std::size_t k);

/// What the page needs to show a channel that is not drawn.
[[nodiscard]] nlohmann::ordered_json described(const Channel& channel);

}  // namespace sdm::io
