// The table of channels: what every row must have, and what is read by it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/map.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "support/shapes.h"

namespace sdm::test {
namespace {

using ::testing::ElementsAre;

const Channel& channel_named(std::string_view name) {
  for (const Channel& channel : channels())
    if (channel.name == name) return channel;
  throw std::out_of_range("no such channel");
}

template <class T>
std::vector<T> as(const std::vector<std::byte>& bytes) {
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

TEST(Channels, AreCompleteAndHaveNamesOfTheirOwn) {
  std::set<std::string> names;
  for (const Channel& channel : channels()) {
    EXPECT_TRUE(names.insert(channel.name).second) << channel.name;
    EXPECT_GE(channel.components(), 1u) << channel.name;
    for (std::size_t k = 0; k < channel.components(); ++k)
      EXPECT_TRUE(names.insert(channel.planes[k]).second) << channel.planes[k];
    EXPECT_NE(channel.read, nullptr) << channel.name;
    EXPECT_FALSE(std::string_view(channel.description).empty()) << channel.name;
    EXPECT_FALSE(std::string_view(channel.description).ends_with('.')) << channel.name;
    EXPECT_FALSE(std::string_view(channel.none).empty()) << channel.name;
    const bool needs = channel.needs_shape || channel.needs_sites || channel.needs_boundary;
    EXPECT_FALSE(channel.at_vertices && needs) << channel.name;
  }
}

TEST(Channels, LayersAreInTheOrderOfTheTable) {
  EXPECT_THAT(channel_layers(), ElementsAre("distance", "vector", "site", "face", "position", "barycentric",
                                            "normal", "closest"));
  EXPECT_THAT(default_channel_layers(), ElementsAre("distance", "vector", "site", "face"));
}

struct ChannelsOfMap : ::testing::Test {
  Mesh target = [] {
    Mesh mesh = ring(9, 0.7, {0.4, 0.1, 0.2});
    mesh.triangles.resize(100);
    return mesh;
  }();
  Surface surface{ring(12), {.resolution = 64}};
  Sites sites{target};
  DistanceMap map = compute_map(surface, sites, {.max_distance = 1});
  std::vector<std::uint8_t> boundary = boundary_mask(sites, map);
  ChannelSource source{&map, &surface, &sites, boundary};

  template <class T>
  [[nodiscard]] std::vector<T> read(std::string_view name, std::span<const std::uint32_t> texels,
                                    std::uint32_t first = 0) const {
    return as<T>(read_channels(std::span(&channel_named(name), 1), source, texels, first)[0]);
  }
};

TEST_F(ChannelsOfMap, AreThoseOfItsArraysAndMeshes) {
  const auto texels = surface.sample_texels();
  const auto distance = read<float>("distance", texels);
  const auto vector = read<Vec3f>("vector", texels);
  const auto site = read<std::uint32_t>("site", texels);
  const auto site_type = read<SiteType>("site_type", texels);
  const auto face = read<std::uint32_t>("face", texels);
  const auto position = read<Vec3>("position", texels);
  const auto weights = read<Vec3>("barycentric", texels);
  const auto at_boundary = read<float>("boundary", texels);
  for (std::size_t i = 0; i < texels.size(); ++i) {
    const std::uint32_t t = texels[i];
    ASSERT_EQ(std::isnan(distance[i]), map.site_type[t] == SiteType::none);
    if (!std::isnan(distance[i])) {
      ASSERT_EQ(distance[i], map.distance[t]);
      ASSERT_EQ(vector[i], map.vector[t]);
    }
    ASSERT_EQ(site[i], map.site[t]);
    ASSERT_EQ(site_type[i], map.site_type[t]);
    ASSERT_EQ(face[i], surface.map_faces()[t]);
    ASSERT_EQ(position[i], surface.texel_point(t));
    Vec3 sum{};
    for (int k = 0; k < 3; ++k)
      sum = sum + weights[i][k] * surface.mesh().positions[surface.mesh().triangles[face[i]][k]];
    ASSERT_LT(norm(sum - position[i]), 1e-12);
    ASSERT_EQ(at_boundary[i], boundary[t]);
  }
}

TEST_F(ChannelsOfMap, HaveTheirOwnValueForNone) {
  const std::uint32_t texels[] = {kNone};
  for (const Channel& channel : channels()) {
    const auto bytes = read_channels(std::span(&channel, 1), source, texels)[0];
    ASSERT_EQ(bytes.size(), channel.components() * size_of(channel.type));
    const std::string none = channel.none;
    for (std::size_t k = 0; k < channel.components(); ++k) switch (channel.type) {
        case ChannelType::float32:
          EXPECT_EQ(none == "NaN", std::isnan(as<float>(bytes)[k])) << channel.name;
          break;
        case ChannelType::float64:
          EXPECT_EQ(none == "NaN", std::isnan(as<double>(bytes)[k])) << channel.name;
          break;
        case ChannelType::uint32:
          EXPECT_EQ(none, std::to_string(as<std::uint32_t>(bytes)[k])) << channel.name;
          break;
        case ChannelType::uint8:
          EXPECT_EQ(none, std::to_string(as<std::uint8_t>(bytes)[k])) << channel.name;
          break;
      }
  }
}

TEST_F(ChannelsOfMap, CoverTexelsThatHaveTheirOwnValues) {
  const std::uint32_t t = surface.sample_texels()[0];
  const std::vector<std::uint32_t> texels{t, t, kNone};
  EXPECT_THAT(read<float>("coverage", texels, t), ElementsAre(1, 0, 0));
}

TEST_F(ChannelsOfMap, NameWhatTheyNeed) {
  source.sites = nullptr;
  source.boundary = {};
  const std::uint32_t texels[] = {surface.sample_texels()[0]};
  for (const char* name : {"closest_face", "closest_uv", "boundary"})
    EXPECT_THROW(static_cast<void>(read<float>(name, texels)), Error) << name;
  source.surface = nullptr;
  EXPECT_EQ(read<float>("distance", texels).size(), 1u);
  EXPECT_THROW(static_cast<void>(read<std::uint32_t>("face", texels)), Error);
}

/// The row of the table in docs/report.md.
std::string documented(const Channel& channel) {
  std::string line = "| ";
  for (std::size_t k = 0; k < channel.components(); ++k)
    line += (k > 0 ? ", `" : "`") + std::string(channel.planes[k]) + '`';
  std::string layer, array;
  if (*channel.layer != '\0') layer = '`' + std::string(channel.layer) + '`';
  if (channel.on_request) layer += ", on request";
  if (channel.in_python) array = '`' + std::string(channel.name) + '`';
  return line + " | " + layer + " | " + array + " | " + name_of(channel.type) + " | " + channel.none + " | " +
         channel.description + " |";
}

TEST(Channels, AreDocumented) {
  std::ifstream file(SDM_REPORT_DOCS);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  for (const Channel& channel : channels()) EXPECT_THAT(text, ::testing::HasSubstr(documented(channel)));
}

}  // namespace
}  // namespace sdm::test
