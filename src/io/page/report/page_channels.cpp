#include "io/page/report/page_channels.h"

#include <cstring>
#include <string_view>

#include "io/page/report/page_numbers.h"

namespace sdm::io {
namespace {

template <class T>
T number_at(const std::byte* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

std::uint32_t packed(ChannelType type, const std::byte* from) {
  switch (type) {
    case ChannelType::float32:
      return ordered(number_at<float>(from));
    case ChannelType::float64:
      return ordered(static_cast<float>(number_at<double>(from)));
    case ChannelType::uint32:
      return number_at<std::uint32_t>(from);
    case ChannelType::uint8:
      break;
  }
  const auto byte = number_at<std::uint8_t>(from);
  return byte == 0xFF ? kNone : byte;
}

bool is_float(ChannelType type) {
  return type == ChannelType::float32 || type == ChannelType::float64;
}

}  // namespace

PageChannels::PageChannels() {
  for (const Channel& channel : sdm::channels())
    if (channel.on_page) {
      channels_.push_back(channel);
      planes_ += channel.components();
    }
}

void PageChannels::read(const ChannelSource& source, std::span<const std::uint32_t> texels, std::size_t first,
                        std::span<std::vector<std::uint32_t>> planes) const {
  const auto values = read_channels(channels_, source, texels);
  std::size_t plane = 0;
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    const std::size_t components = channels_[c].components(), size = size_of(channels_[c].type);
    for (std::size_t k = 0; k < components; ++k, ++plane)
      for (std::size_t i = 0; i < texels.size(); ++i)
        planes[plane][first + i] = packed(channels_[c].type, values[c].data() + (i * components + k) * size);
  }
}

bool is_drawn(const Channel& channel) {
  return channel.name == std::string_view("distance");
}

std::string array_name(const Channel& channel, std::size_t k) {
  return is_drawn(channel) ? channel.name : "texel_" + std::string(channel.name) + '_' + std::to_string(k);
}

nlohmann::ordered_json described(const Channel& channel) {
  return {{"name", channel.name},
          {"components", channel.components()},
          {"whole", !is_float(channel.type)},
          {"length", channel.is_length}};
}

}  // namespace sdm::io
