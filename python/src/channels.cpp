// The arrays of a map: one for each row of the table of channels.
#include <nanobind/stl/string.h>
#include <sdm/map.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <map>
#include <numeric>
#include <optional>

#include "arrays.h"
#include "map.h"

namespace sdm::python {
namespace {

using ReadOnly = nb::ndarray<nb::numpy, nb::ro>;

nb::dlpack::dtype dtype_of(ChannelType type) {
  switch (type) {
    case ChannelType::float32:
      return nb::dtype<float>();
    case ChannelType::float64:
      return nb::dtype<double>();
    case ChannelType::uint32:
      return nb::dtype<std::uint32_t>();
    case ChannelType::uint8:
      return nb::dtype<std::uint8_t>();
  }
  return {};
}

nb::object channel_array(const Channel& channel, const PyMap& map, const std::byte* values,
                         nb::handle owner) {
  const std::size_t components = channel.components();
  const std::size_t shape[] = {map.rows(), map.map.resolution, components};
  return nb::cast(ReadOnly(values, components > 1 ? 3 : 2, shape, owner, nullptr, dtype_of(channel.type)));
}

// The values of all texels of a channel that the map does not store.
std::vector<std::byte> computed(const Channel& channel, const PyMap& map) {
  constexpr std::size_t kBlock = 4096;  // texels
  const ChannelSource source{.map = &map.map, .surface = &map.on->surface, .sites = &map.to->sites};
  const auto owners = map.on->surface.texel_faces();
  const std::size_t size = channel.components() * size_of(channel.type);
  std::vector<std::byte> values(map.texels() * size);
  for_parts(map.texels(), [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> texels;
    for (; begin < end; begin += texels.size()) {
      texels.resize(std::min(kBlock, end - begin));
      std::iota(texels.begin(), texels.end(), static_cast<std::uint32_t>(begin));
      for (std::uint32_t& texel : texels)
        if (owners[texel] == kNone) texel = kNone;
      const auto read = read_channels({&channel, 1}, source, texels, static_cast<std::uint32_t>(begin));
      std::memcpy(values.data() + begin * size, read[0].data(), read[0].size());
    }
  });
  return values;
}

// The base class of DistanceMap.
struct PyMapChannels {
  explicit PyMapChannels(nb::handle of) : object(nb::borrow(of)), map(&nb::cast<const PyMap&>(of)) {}

  nb::object object;
  const PyMap* map;
  std::map<const char*, nb::object> arrays;  ///< made by the first access

  nb::object get(const Channel& channel) {
    nb::object& array = arrays[channel.name];
    if (!array.is_valid()) array = made(channel);
    return array;
  }

 private:
  [[nodiscard]] nb::object made(const Channel& channel) const {
    if (channel.stored != nullptr)
      return channel_array(channel, *map, channel.stored(map->map).data(), object);
    const auto lock = channel.needs_shape ? map->use_surface() : map->use_texels();
    std::optional<Use> sites_lock;
    if (channel.needs_sites) sites_lock = map->use_sites();
    auto values =
        std::make_unique<std::vector<std::byte>>(run_short([&] { return computed(channel, *map); }));
    const std::byte* data = values->data();
    return channel_array(channel, *map, data, detail::capsule_of(values.release()));
  }
};

std::string documentation(const Channel& channel) {
  std::string text = channel.description;
  for (std::size_t at = 0; (at = text.find('`', at)) != std::string::npos; at += 2) text.insert(at, 1, '`');
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  const std::size_t components = channel.components();
  text += components > 1 ? ", (H, W, " + std::to_string(components) + ") " : ", (H, W) ";
  return text + name_of(channel.type) + "; " + (channel.type == ChannelType::uint32 ? "NONE" : channel.none) +
         " without a value.";
}

}  // namespace

void bind_channels(nb::module_& module) {
  nb::class_<PyMapChannels> channels_class(
      module, "MapChannels",
      "The arrays of a DistanceMap, read-only: what it has at each texel. The measured mesh is the surface, "
      "the other mesh that of the sites.");
  channels_class.def(nb::init<nb::handle>(), nb::arg("map"), nb::sig("def __init__(self, map: Map) -> None"));
  for (const Channel& channel : channels()) {
    if (!channel.in_python) continue;
    const std::string signature = "def " + std::string(channel.name) +
                                  "(self) -> numpy.typing.NDArray[numpy." + name_of(channel.type) + "]";
    channels_class.def_prop_ro(
        channel.name, [&channel](PyMapChannels& self) { return self.get(channel); },
        nb::sig(signature.c_str()), documentation(channel).c_str());
  }
}

}  // namespace sdm::python
