
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/closest_points.h>
#include <sdm/error.h>
#include <sdm/map_files.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <vector>

#include "support/made_up_maps.h"
#include "support/owned_texels.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace sdm::test {
namespace {

/// All channels as bits, so that NaN equals NaN.
using Channels = std::map<std::string, std::vector<std::uint32_t>>;

Channels read_exr(const std::filesystem::path& file, std::uint32_t n) {
  Imf::InputFile exr(file.c_str());
  EXPECT_EQ(exr.header().dataWindow().max, Imath::V2i(static_cast<int>(n - 1), static_cast<int>(n - 1)));
  Channels channels;
  Imf::FrameBuffer frame;
  for (auto channel = exr.header().channels().begin(); channel != exr.header().channels().end(); ++channel) {
    auto& values = channels[channel.name()];
    values.resize(std::size_t{n} * n);
    const std::string name = channel.name();
    const bool is_id =
        name == "site.id" || name == "site.type" || name == "face.id" || name == "closest.face";
    EXPECT_EQ(channel.channel().type, is_id ? Imf::UINT : Imf::FLOAT) << name;
    frame.insert(channel.name(), Imf::Slice(channel.channel().type, reinterpret_cast<char*>(values.data()), 4,
                                            std::size_t{4} * n));
  }
  exr.setFrameBuffer(frame);
  exr.readPixels(0, static_cast<int>(n) - 1);
  return channels;
}

/// The values in the file for a texel whose values are those of texel `source`.
std::vector<std::uint32_t> expected(const Surface& surface, const DistanceMap& map, std::size_t source) {
  const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x); };
  const Vec3f& v = map.vector[source];
  const SiteType type = map.site_type[source];
  return {bits(map.distance[source]),
          bits(v[0]),
          bits(v[1]),
          bits(v[2]),
          map.site[source],
          type == SiteType::none ? kNone : static_cast<std::uint32_t>(type),
          surface.map_faces()[source]};
}

TEST(Exr, MapsOverTime) {
  const Surface surface(ring(12), {.resolution = 64});
  TemporalMaps maps;
  for (int t = 0; t < 3; ++t) maps.add(map_of(surface, [t](const Vec3& p) { return p[t]; }));
  const TemporaryFolder folder;
  write_exr(folder / "temporal.exr", surface, maps);
  const Channels channels = read_exr(folder / "temporal.exr", 64);
  ASSERT_EQ(channels.size(), 4u);
  for (const std::uint32_t t : test::owned_texels(surface)) {
    const Vec3 p = surface.texel_point(t);
    const auto value = [&](const char* name) { return std::bit_cast<float>(channels.at(name)[t]); };
    ASSERT_FLOAT_EQ(value("min.D"), static_cast<float>(std::min({p[0], p[1], p[2]})));
    ASSERT_FLOAT_EQ(value("max.D"), static_cast<float>(std::max({p[0], p[1], p[2]})));
    ASSERT_NEAR(value("mean.D"), (p[0] + p[1] + p[2]) / 3, 1e-6);
    ASSERT_EQ(value("coverage.A"), 1);
  }
  EXPECT_THROW(write_exr(folder / "other.exr", Surface(ring(12), {.resolution = 32}), maps), Error);
  EXPECT_FALSE(std::filesystem::exists(folder / "other.exr"));
}

std::vector<std::uint32_t> found(const Channels& channels, std::size_t texel) {
  std::vector<std::uint32_t> values;
  for (const char* name :
       {"distance.D", "vector.X", "vector.Y", "vector.Z", "site.id", "site.type", "face.id"})
    values.push_back(channels.at(name)[texel]);
  return values;
}

void expect_holds(const Surface& surface, const DistanceMap& map) {
  const TemporaryFolder folder;
  write_exr(folder / "map.exr", surface, map);
  const int n = static_cast<int>(map.resolution);
  const Channels channels = read_exr(folder / "map.exr", map.resolution);
  EXPECT_EQ(channels.size(), 8u);

  const auto owners = surface.texel_faces();
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const std::size_t texel = static_cast<std::size_t>(y) * map.resolution + static_cast<std::size_t>(x);
      const bool owned = owners[texel] != kNone;
      ASSERT_EQ(std::bit_cast<float>(channels.at("coverage.A")[texel]), owned ? 1.f : 0.f);
      const auto values = found(channels, texel);
      if (owned) {
        ASSERT_EQ(values, expected(surface, map, texel)) << x << ", " << y;
        continue;
      }
      // A free texel has the values of one of its nearest owned texels, within four rings.
      constexpr int kRing = 1000, kBeyond = 5 * kRing;
      int nearest = kBeyond;
      bool matches = false;
      for (int sy = std::max(0, y - 4); sy <= std::min(n - 1, y + 4); ++sy)
        for (int sx = std::max(0, x - 4); sx <= std::min(n - 1, x + 4); ++sx) {
          const std::size_t source =
              static_cast<std::size_t>(sy) * map.resolution + static_cast<std::size_t>(sx);
          const int distance = kRing * std::max(std::abs(sx - x), std::abs(sy - y)) + (sx - x) * (sx - x) +
                               (sy - y) * (sy - y);
          if (owners[source] == kNone || distance > nearest) continue;
          if (distance < nearest) matches = false;
          nearest = distance;
          matches = matches || values == expected(surface, map, source);
        }
      if (nearest < kBeyond) {
        ASSERT_TRUE(matches) << x << ", " << y;
      } else {
        ASSERT_TRUE(std::isnan(std::bit_cast<float>(values[0])) &&
                    std::isnan(std::bit_cast<float>(values[3])));
        ASSERT_THAT((std::vector<std::uint32_t>(values.begin() + 4, values.end())), ::testing::Each(kNone));
      }
    }
}

TEST(Exr, KeepsEveryBitAndFillsGutters) {
  for (const AtlasKind kind : {AtlasKind::triangles, AtlasKind::charts}) {
    const Surface surface(ring(6), {.kind = kind, .resolution = 200});
    expect_holds(surface, map_of(surface, [](const Vec3& p) { return p[0] * p[1] - p[2]; }));
  }
}

// A compressor once wrote other bytes for the same data, but rarely: this only shows gross differences.
TEST(Exr, IsTheSameFileEachTime) {
  const Surface surface(ring(40), {.resolution = 512});
  const DistanceMap map = map_of(surface, [](const Vec3& p) { return std::sin(40 * p[0]) * p[1]; });
  const TemporaryFolder folder;
  const auto written = [&] {
    write_exr(folder / "map.exr", surface, map);
    std::ifstream file(folder / "map.exr", std::ios::binary);
    return std::string{std::istreambuf_iterator<char>(file), {}};
  };
  const std::string first = written();
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(written() == first);
}

// A sphere around a square: its texels are closest to the square's inside near the axis, to its sides
// elsewhere.
TEST(Exr, MarksTheBoundaryOfAnOpenMesh) {
  const Surface surface(sphere(3), {.resolution = 64});
  const Sites square_sites(square(1, 0));
  const DistanceMap map = compute_map(surface, square_sites);
  const std::vector<std::uint8_t> mask = boundary_mask(square_sites, map);
  const TemporaryFolder folder;
  write_exr(folder / "map.exr", surface, map, {.boundary = mask});
  const Channels channels = read_exr(folder / "map.exr", map.resolution);
  EXPECT_EQ(channels.size(), 9u);
  std::size_t marked = 0;
  for (const std::uint32_t t : test::owned_texels(surface)) {
    const Vec3 p = surface.texel_point(t);
    const double beyond = std::max(std::abs(p[0]), std::abs(p[1])) - 0.5;  // of the square's sides
    const bool is_marked = std::bit_cast<float>(channels.at("boundary.M")[t]) == 1;
    if (std::abs(beyond) > 1e-6) {
      ASSERT_EQ(is_marked, beyond > 0);
    }
    marked += is_marked;
  }
  EXPECT_GT(marked, 0u);
  EXPECT_LT(marked, surface.owned_texels());
  EXPECT_THROW(write_exr(folder / "other.exr", surface, map, {.boundary = std::vector<std::uint8_t>(3)}),
               Error);
  EXPECT_THROW(static_cast<void>(boundary_mask(Sites(single_triangle()), map)), Error);
}

// The position, closest face and weights of every texel give its vector.
TEST(Exr, HasFurtherLayersAndAttributesOnRequest) {
  Mesh target = ring(9, 0.7, {0.4, 0.1, 0.2});
  target.triangles.resize(100);  // open: closest edges and vertices of one face
  const Surface surface(ring(12), {.resolution = 64});
  const Sites sites(target);
  const DistanceMap map = compute_map(surface, sites, {.max_distance = 1});
  ASSERT_GT(map.beyond_max_distance, 0u);
  const TemporaryFolder folder;
  ExrOptions options{.layers = {"distance", "vector", "face", "position", "normal", "closest"},
                     .sites = &sites,
                     .attributes = {{"units", "mm"}, {"sign", ""}}};
  write_exr(folder / "map.exr", surface, map, options);
  const Channels channels = read_exr(folder / "map.exr", 64);
  EXPECT_EQ(channels.size(), 15u);
  EXPECT_FALSE(channels.contains("site.id"));
  const auto value = [&](const std::string& name, std::uint32_t t) {
    return double{std::bit_cast<float>(channels.at(name)[t])};
  };
  for (const std::uint32_t t : test::owned_texels(surface)) {
    const Vec3 p = surface.texel_point(t);
    const Triangle& owner = surface.mesh().triangles[surface.map_faces()[t]];
    const std::uint32_t face = channels.at("closest.face")[t];
    if (map.site_type[t] == SiteType::none) {
      ASSERT_EQ(face, kNone);
      ASSERT_TRUE(std::isnan(value("closest.U", t)));
      continue;
    }
    const double u = value("closest.U", t), v = value("closest.V", t);
    ASSERT_GE(std::min({u, v, 1 - u - v}), -1e-7);
    const Triangle& triangle = target.triangles.at(face);
    double along[2] = {0, 0}, length = 0;
    for (int k = 0; k < 3; ++k) {
      const std::string axis = {"XYZ"[k]};
      const auto corner = [&](int i) { return target.positions[triangle[i]][k]; };
      const double closest = (1 - u - v) * corner(0) + u * corner(1) + v * corner(2);
      ASSERT_NEAR(value("position." + axis, t), p[k], 1e-6);
      ASSERT_NEAR(closest - p[k], value("vector." + axis, t), 1e-6);
      const double n = value("normal." + axis, t);
      length += n * n;
      for (int i = 0; i < 2; ++i)
        along[i] += n * (surface.mesh().positions[owner[i + 1]][k] - surface.mesh().positions[owner[0]][k]);
    }
    ASSERT_NEAR(length, 1, 1e-6);
    ASSERT_NEAR(along[0], 0, 1e-6);
    ASSERT_NEAR(along[1], 0, 1e-6);
  }
  const Imf::InputFile exr((folder / "map.exr").c_str());
  EXPECT_EQ(exr.header().typedAttribute<Imf::StringAttribute>("units").value(), "mm");
  EXPECT_EQ(exr.header().typedAttribute<Imf::StringAttribute>("sign").value(), "");
  options.layers = {"depth"};
  EXPECT_THROW(write_exr(folder / "other.exr", surface, map, options), Error);
  options.layers = {"closest"};
  options.sites = nullptr;
  EXPECT_THROW(write_exr(folder / "other.exr", surface, map, options), Error);
  EXPECT_EQ(point_on_face(sites, SiteType::none, kNone, {}).face, kNone);
  EXPECT_THROW((void)point_on_face(sites, SiteType::edge, 1u << 30, {}), Error);
}

TEST(Exr, MissingValuesAreNaNAndNone) {
  const Surface surface(ring(6), {.kind = AtlasKind::triangles, .resolution = 300});
  const DistanceMap map = map_of(surface, [](const Vec3& p) { return p[0] < 0 ? p[1] : std::nan(""); });
  ASSERT_GT(map.beyond_max_distance, 0u);
  expect_holds(surface, map);
}

TEST(Exr, NothingInRangeIsInfinity) {
  const Surface surface(ring(6), {.kind = AtlasKind::triangles, .resolution = 300});
  const DistanceMap map = map_of(
      surface, [](const Vec3& p) { return p[0] < 0 ? p[1] : std::numeric_limits<double>::infinity(); });
  ASSERT_GT(map.beyond_max_distance, 0u);
  expect_holds(surface, map);
}

TEST(Exr, SmallestMap) {
  const Surface surface(ring(3), {.kind = AtlasKind::charts, .resolution = 64});
  expect_holds(surface, map_of(surface, [](const Vec3&) { return -0.0; }));
}

}  // namespace
}  // namespace sdm::test
