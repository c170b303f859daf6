#include <sdm/error.h>
#include <sdm/map.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <new>
#include <type_traits>

#include "core/memory.h"
#include "map/transfer/closest_of_texels.h"

namespace sdm {

/// Some texels, and what several channels need at them, computed once.
class map::TexelBlock {
 public:
  TexelBlock(const ChannelSource& source, std::span<const std::uint32_t> texels, std::uint32_t first)
      : source_(source), texels_(texels), first_(first) {}

  [[nodiscard]] const ChannelSource& source() const { return source_; }
  [[nodiscard]] std::span<const std::uint32_t> texels() const { return texels_; }
  /// Whether texel i stands for itself, not for one without values of its own.
  [[nodiscard]] bool is_own(std::size_t i) const { return texels_[i] == first_ + i; }
  [[nodiscard]] std::uint32_t owner(std::size_t i) const {
    return source_.surface->texel_faces()[texels_[i]];
  }

  [[nodiscard]] const Vec3& point(std::size_t i) const {
    if (points_.empty())
      fill(points_, [&](std::size_t k) { return source_.surface->texel_point(texels_[k]); });
    return points_[i];
  }
  [[nodiscard]] const SurfacePoint& closest(std::size_t i) const {
    if (closest_.empty()) {
      ClosestOfTexels points(*source_.surface, *source_.sites, *source_.map);
      fill(closest_, [&](std::size_t k) { return points.at(texels_[k]); });
    }
    return closest_[i];
  }

 private:
  template <class T, class Get>
  void fill(std::vector<T>& values, const Get& get) const {
    values.resize(texels_.size());
    for (std::size_t i = 0; i < values.size(); ++i)
      if (texels_[i] != kNone) values[i] = get(i);
  }

  const ChannelSource& source_;
  std::span<const std::uint32_t> texels_;
  std::uint32_t first_;
  mutable std::vector<Vec3> points_;
  mutable std::vector<SurfacePoint> closest_;
};

namespace {

using map::TexelBlock;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// A number that is 0 where there is no value.
struct Flag {
  float value = 0;
};

/// The type of channels whose values are of type T, and the value of a texel without one.
template <class T>
struct Values;
template <>
struct Values<float> {
  static constexpr ChannelType kType = ChannelType::float32;
  static constexpr float kNoValue = kNaN;
  static constexpr const char* kText = "NaN";
};
template <>
struct Values<Flag> {
  static constexpr ChannelType kType = ChannelType::float32;
  static constexpr Flag kNoValue{};
  static constexpr const char* kText = "0";
};
template <std::size_t N>
struct Values<std::array<float, N>> {
  static constexpr ChannelType kType = ChannelType::float32;
  static constexpr std::array<float, N> kNoValue = [] {
    std::array<float, N> values{};
    values.fill(kNaN);
    return values;
  }();
  static constexpr const char* kText = "NaN";
};
template <>
struct Values<Vec3f> {
  static constexpr ChannelType kType = ChannelType::float32;
  static constexpr Vec3f kNoValue{kNaN, kNaN, kNaN};
  static constexpr const char* kText = "NaN";
};
template <>
struct Values<Vec3> {
  static constexpr ChannelType kType = ChannelType::float64;
  static constexpr Vec3 kNoValue{kNaN, kNaN, kNaN};
  static constexpr const char* kText = "NaN";
};
template <>
struct Values<std::uint32_t> {
  static constexpr ChannelType kType = ChannelType::uint32;
  static constexpr std::uint32_t kNoValue = kNone;
  static constexpr const char* kText = "4294967295";
};
template <>
struct Values<std::uint8_t> {
  static constexpr ChannelType kType = ChannelType::uint8;
  static constexpr std::uint8_t kNoValue = 0xFF;
  static constexpr const char* kText = "255";
};
template <>
struct Values<SiteType> {
  static constexpr ChannelType kType = ChannelType::uint8;
  static constexpr SiteType kNoValue = SiteType::none;
  static constexpr const char* kText = "255";
};

// Completes a row whose values are value(block, i), for each texel i of the block that has one.
template <auto Value>
constexpr Channel computed(Channel row) {
  using T = std::remove_cvref_t<std::invoke_result_t<decltype(Value), const TexelBlock&, std::size_t>>;
  row.type = Values<T>::kType;
  row.none = Values<T>::kText;
  row.read = [](const TexelBlock& block, std::byte* values) {
    for (std::size_t i = 0; i < block.texels().size(); ++i) {
      const T value = block.texels()[i] == kNone ? Values<T>::kNoValue : Value(block, i);
      std::memcpy(values + i * sizeof(T), &value, sizeof(T));
    }
  };
  return row;
}

template <auto Member>
auto value_in_map(const TexelBlock& block, std::size_t i) {
  return (block.source().map->*Member)[block.texels()[i]];
}

// Completes a row whose values are an array of the map.
template <auto Member>
constexpr Channel stored(Channel row) {
  row = computed<value_in_map<Member>>(row);
  row.stored = [](const DistanceMap& map) { return std::as_bytes(std::span(map.*Member)); };
  return row;
}

std::uint32_t face(const TexelBlock& block, std::size_t i) {
  return block.owner(i);
}

Vec3 position(const TexelBlock& block, std::size_t i) {
  return block.point(i);
}

Vec3 own_barycentric(const TexelBlock& block, std::size_t i) {
  const auto [a, b, c] = corners_of(block.source().surface->mesh(), block.owner(i));
  return barycentric(a, b, c, block.point(i));
}

Vec3f normal(const TexelBlock& block, std::size_t i) {
  const Mesh& mesh = block.source().surface->mesh();
  const auto& [a, b, c] = mesh.triangles[block.owner(i)];
  const Vec3 first = mesh.positions[b] - mesh.positions[a], second = mesh.positions[c] - mesh.positions[a];
  Vec3 normal = cross(first, second);
  normal = (1 / norm(normal)) * normal;
  return {static_cast<float>(normal[0]), static_cast<float>(normal[1]), static_cast<float>(normal[2])};
}

std::uint32_t closest_face(const TexelBlock& block, std::size_t i) {
  return block.closest(i).face;
}

std::array<float, 2> closest_uv(const TexelBlock& block, std::size_t i) {
  const SurfacePoint& closest = block.closest(i);
  if (closest.face == kNone) return {kNaN, kNaN};
  return {static_cast<float>(closest.barycentric[1]), static_cast<float>(closest.barycentric[2])};
}

Flag coverage(const TexelBlock& block, std::size_t i) {
  return {block.is_own(i) ? 1.f : 0.f};
}

Flag boundary(const TexelBlock& block, std::size_t i) {
  return {block.source().boundary[block.texels()[i]] != 0 ? 1.f : 0.f};
}

constexpr Channel kChannels[] = {
    stored<&DistanceMap::distance>(
        {.name = "distance",
         .layer = "distance",
         .planes = {"distance.D"},
         .description = "the length of `vector`, negative inside the other mesh if distances are signed",
         .is_length = true,
         .on_page = true,
         .at_vertices = true}),
    stored<&DistanceMap::vector>(
        {.name = "vector",
         .layer = "vector",
         .planes = {"vector.X", "vector.Y", "vector.Z"},
         .description = "from the surface point of the texel's centre to the closest point of the other mesh",
         .is_length = true}),
    stored<&DistanceMap::site>(
        {.name = "site",
         .layer = "site",
         .planes = {"site.id"},
         .description = "the closest vertex, edge or face of the other mesh, by `site_type`"}),
    stored<&DistanceMap::site_type>({.name = "site_type",
                                     .layer = "site",
                                     .planes = {"site.type"},
                                     .description = "what the site is: 0 a vertex, 1 an edge, 2 a face"}),
    computed<face>({.name = "face",
                    .layer = "face",
                    .planes = {"face.id"},
                    .description = "the face of the measured mesh that owns the texel"}),
    computed<position>({.name = "position",
                        .layer = "position",
                        .planes = {"position.X", "position.Y", "position.Z"},
                        .description = "the surface point of the texel's centre",
                        .is_length = true,
                        .on_request = true,
                        .needs_shape = true}),
    computed<own_barycentric>(
        {.name = "barycentric",
         .layer = "barycentric",
         .planes = {"barycentric.A", "barycentric.B", "barycentric.C"},
         .description = "where the texel's centre is on `face`: the weights of its corners",
         .on_request = true,
         .needs_shape = true}),
    computed<normal>(
        {.name = "normal",
         .layer = "normal",
         .planes = {"normal.X", "normal.Y", "normal.Z"},
         .description = "the unit normal of the face that owns the texel, by the order of its corners",
         .on_request = true,
         .needs_shape = true}),
    computed<closest_face>({.name = "closest_face",
                            .layer = "closest",
                            .planes = {"closest.face"},
                            .description = "a face of the other mesh with the closest point",
                            .on_request = true,
                            .needs_shape = true,
                            .needs_sites = true}),
    computed<closest_uv>({.name = "closest_uv",
                          .layer = "closest",
                          .planes = {"closest.U", "closest.V"},
                          .description = "where the closest point is on that face: the weights of its second "
                                         "and third corner",
                          .on_request = true,
                          .needs_shape = true,
                          .needs_sites = true}),
    computed<coverage>({.name = "coverage",
                        .layer = "",
                        .planes = {"coverage.A"},
                        .description = "1 where a face owns the texel, also without a value",
                        .in_python = false}),
    computed<boundary>({.name = "boundary",
                        .layer = "",
                        .planes = {"boundary.M"},
                        .description = "1 where the closest point lies on the boundary of the other mesh, "
                                       "if that is open",
                        .in_python = false,
                        .needs_boundary = true}),
};

std::vector<std::string> layers(bool on_request_too) {
  std::vector<std::string> names;
  for (const Channel& channel : kChannels)
    if (*channel.layer != '\0' && (on_request_too || !channel.on_request) &&
        std::ranges::count(names, channel.layer) == 0)
      names.emplace_back(channel.layer);
  return names;
}

void require(bool given, const Channel& channel, const char* what) {
  if (!given) throw Error(std::string("the channel `") + channel.name + "` needs " + what + " of the map");
}

}  // namespace

std::span<const Channel> channels() {
  return kChannels;
}

std::size_t size_of(ChannelType type) {
  switch (type) {
    case ChannelType::float64:
      return 8;
    case ChannelType::uint8:
      return 1;
    default:
      return 4;
  }
}

const char* name_of(ChannelType type) {
  switch (type) {
    case ChannelType::float32:
      return "float32";
    case ChannelType::float64:
      return "float64";
    case ChannelType::uint32:
      return "uint32";
    case ChannelType::uint8:
      return "uint8";
  }
  return "";
}

std::vector<std::string> channel_layers() {
  return layers(true);
}

std::vector<std::string> default_channel_layers() {
  return layers(false);
}

std::vector<std::vector<std::byte>> read_channels(std::span<const Channel> channels,
                                                  const ChannelSource& source,
                                                  std::span<const std::uint32_t> texels,
                                                  std::uint32_t first) try {
  const TexelBlock block(source, texels, first);
  std::vector<std::vector<std::byte>> values;
  for (const Channel& channel : channels) {
    require(source.map != nullptr, channel, "the distances");
    require(source.surface != nullptr || channel.stored != nullptr || channel.at_vertices, channel,
            "the surface");
    require(source.sites != nullptr || !channel.needs_sites, channel, "the sites");
    require(source.boundary.size() == source.map->distance.size() || !channel.needs_boundary, channel,
            "the mask of the boundary");
    auto& of_channel = values.emplace_back(texels.size() * channel.components() * size_of(channel.type));
    channel.read(block, of_channel.data());
  }
  return values;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the channels of a map");
}

}  // namespace sdm
