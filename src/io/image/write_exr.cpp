#include "atlas/gutter.h"
#include "core/memory.h"
#include "io/image/exr_planes.h"

#include <sdm/error.h>
#include <sdm/map.h>
#include <sdm/map_files.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <limits>
#include <map>
#include <new>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace sdm {

using namespace io;

namespace {

// Writes the values that read(sources, first, row) puts into each row of texels, one plane after another.
// `sources`: the owned texels whose values the texels from `first` on have, a neighbour's in gutters; kNone
// where there is none.
template <class Read>
void write_planes_of(const std::filesystem::path& file, const Surface& surface,
                     std::span<const ExrPlane> planes,
                     const std::vector<std::pair<std::string, std::string>>& attributes, const Read& read) {
  const std::uint32_t n = surface.resolution();
  const atlas::Gutter gutter(n, surface.texel_faces(), std::max(atlas::kGutter, surface.gutter()));
  write_planes(file, n, surface.rows(), planes, {"surface distance map", attributes},
               [&](std::uint32_t y, std::span<std::uint32_t> row) {
                 std::vector<std::uint32_t> sources(n);
                 for (std::uint32_t x = 0; x < n; ++x) sources[x] = gutter.source(x, y);
                 read(std::span<const std::uint32_t>(sources), y * n, row);
               });
}

// Where a plane of the file comes from.
struct Component {
  std::size_t channel;  // of those that are read
  std::size_t index;    // of the value's components
};

// What a file contains: the channels that are read, and the components of these, in the order of their names.
struct Contents {
  std::vector<Channel> channels;
  std::vector<ExrPlane> planes;
  std::vector<Component> components;  // of each plane
};

bool is_whole(ChannelType type) {
  return type != ChannelType::float32 && type != ChannelType::float64;
}

Contents contents_of(const ExrOptions& options) {
  Contents contents;
  std::map<std::string, Component> by_name;
  for (const Channel& channel : channels()) {
    const bool chosen = *channel.layer == '\0' || std::ranges::count(options.layers, channel.layer) > 0;
    if (!chosen || (channel.needs_boundary && options.boundary.empty())) continue;
    for (std::size_t k = 0; k < channel.components(); ++k)
      by_name[channel.planes[k]] = {contents.channels.size(), k};
    contents.channels.push_back(channel);
  }
  for (const auto& [name, component] : by_name) {
    contents.planes.push_back({name, is_whole(contents.channels[component.channel].type)});
    contents.components.push_back(component);
  }
  return contents;
}

// The bits of the number at `from` as the file has them.
template <class T>
std::uint32_t bits_of(const std::byte* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  if constexpr (std::is_same_v<T, double>) return std::bit_cast<std::uint32_t>(static_cast<float>(value));
  if constexpr (std::is_same_v<T, std::uint8_t>) return value == 0xFF ? kNone : value;
  if constexpr (sizeof(T) == 4) return std::bit_cast<std::uint32_t>(value);
}

template <class T>
void put(std::span<std::uint32_t> plane, const std::byte* values, std::size_t components, std::size_t k) {
  for (std::size_t i = 0; i < plane.size(); ++i)
    plane[i] = bits_of<T>(values + (i * components + k) * sizeof(T));
}

// Puts component k of a channel into a plane.
void put(std::span<std::uint32_t> plane, const Channel& channel, std::span<const std::byte> values,
         std::size_t k) {
  const auto put_as = [&]<class T>(T) { put<T>(plane, values.data(), channel.components(), k); };
  switch (channel.type) {
    case ChannelType::float64:
      return put_as(double{});
    case ChannelType::uint8:
      return put_as(std::uint8_t{});
    case ChannelType::float32:
    case ChannelType::uint32:
      return put_as(std::uint32_t{});
  }
}

void check(const ExrOptions& options, const DistanceMap& map, const Contents& contents,
           const std::filesystem::path& file) {
  const auto fail = [&](const std::string& why) {
    throw Error("cannot write " + file.string() + ": " + why);
  };
  if (!options.boundary.empty() && options.boundary.size() != map.distance.size())
    fail("the mask of the boundary belongs to another map");
  const std::vector<std::string> layers = channel_layers();
  for (const std::string& layer : options.layers)
    if (std::ranges::count(layers, layer) == 0) fail("there is no layer `" + layer + "`");
  for (const Channel& channel : contents.channels)
    if (channel.needs_sites && options.sites == nullptr)
      fail(std::string("the layer `") + channel.layer + "` needs the sites of the map");
}

}  // namespace

void write_exr(const std::filesystem::path& file, const Surface& surface, const DistanceMap& map,
               const ExrOptions& options) try {
  const Contents contents = contents_of(options);
  check(options, map, contents, file);
  const ChannelSource source{&map, &surface, options.sites, options.boundary};
  const std::uint32_t n = surface.resolution();
  write_planes_of(
      file, surface, contents.planes, options.attributes,
      [&](std::span<const std::uint32_t> sources, std::uint32_t first, std::span<std::uint32_t> row) {
        const auto values = read_channels(contents.channels, source, sources, first);
        for (std::size_t p = 0; p < contents.planes.size(); ++p) {
          const auto [channel, index] = contents.components[p];
          put(row.subspan(p * n, n), contents.channels[channel], values[channel], index);
        }
      });
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

void write_exr(const std::filesystem::path& file, const Surface& surface, const TemporalMaps& maps) try {
  if (maps.resolution() != surface.resolution() || maps.least().size() != surface.texel_faces().size())
    throw Error("cannot write " + file.string() + ": the maps belong to another surface");
  constexpr std::size_t kPlanes = 4;
  const std::array<ExrPlane, kPlanes> planes{{{"coverage.A"}, {"max.D"}, {"mean.D"}, {"min.D"}}};
  const std::vector<float> mean = maps.mean();
  const std::array<std::span<const float>, kPlanes> values{{{}, maps.largest(), mean, maps.least()}};
  const std::uint32_t n = surface.resolution();
  write_planes_of(
      file, surface, planes, {},
      [&](std::span<const std::uint32_t> sources, std::uint32_t first, std::span<std::uint32_t> row) {
        for (std::uint32_t x = 0; x < n; ++x) {
          const bool is_own = sources[x] == first + x;
          row[x] = std::bit_cast<std::uint32_t>(is_own ? 1.f : 0.f);
          for (std::size_t p = 1; p < kPlanes; ++p)
            row[p * n + x] = std::bit_cast<std::uint32_t>(
                sources[x] == kNone ? std::numeric_limits<float>::quiet_NaN() : values[p][sources[x]]);
        }
      });
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

std::vector<std::pair<std::string, std::string>> exr_attributes(const MapReport& report,
                                                                const DistanceMap& map,
                                                                const std::string& units) {
  std::vector<std::pair<std::string, std::string>> attributes{{"measuredOn", report.on.file},
                                                              {"distanceTo", report.to.file},
                                                              {"sign", name_of(map.sign.method)},
                                                              {"signReason", map.sign.reason}};
  if (map.measured.kind != DistanceKind::closest) attributes.emplace_back("measured", map.measured.text);
  if (!report.on.transform.empty()) attributes.emplace_back("measuredOnTransform", report.on.transform);
  if (!report.to.transform.empty()) attributes.emplace_back("distanceToTransform", report.to.transform);
  if (!units.empty()) attributes.emplace_back("units", units);
  return attributes;
}

}  // namespace sdm
