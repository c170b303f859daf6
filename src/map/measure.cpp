#include "map/measure.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/arrays/rows.h"
#include "core/parallel.h"
#include "geometry/vec.h"
#include "surface/tiles.h"

namespace sdm::map {
namespace {

constexpr std::size_t kTilesAtOnce = 16, kCornersAtOnce = 768, kPointsAtOnce = 256;
constexpr std::size_t kSamplesAtOnce = 256;  // about, of one call of start()

DistanceMap& described(DistanceMap& map, const Description& description) {
  map.sign = description.sign;
  map.measured = description.measured;
  return map;
}

DistanceMap& cleared(DistanceMap& map, const Surface& surface, const Description& description) {
  clear(map, surface);
  if (may_lack_match(description.measured.kind)) map.unmatched.assign(map.distance.size(), 0);
  return described(map, description);
}

DistanceMap& cleared(DistanceMap& map, const Description& description,
                     std::span<const std::uint32_t> texels) {
  if (may_lack_match(description.measured.kind)) map.unmatched.resize(map.distance.size());
  if (!map.unmatched.empty())
    for (const std::uint32_t texel : texels) map.unmatched[texel] = 0;
  return described(map, description);
}

// The tiles in the order in which they are measured: of one group after another. Empty: in their own.
Array<std::uint32_t> order_of(const surface::Tiles& tiles, const FaceMeasure& measure) {
  if (measure.groups.empty()) return {};
  const std::size_t count = *std::ranges::max_element(measure.groups) + std::size_t{1};
  return make_rows<std::uint32_t>(count,
                                  [&](const auto& put) {
                                    for (std::uint32_t tile = 0; tile < tiles.count(); ++tile)
                                      put(measure.groups[tiles.faces[tile]], tile);
                                  })
      .items;
}

std::optional<Vec3> normal_of(const FaceMeasure& measure, std::uint32_t face) {
  if (measure.normals.empty()) return std::nullopt;
  return measure.normals[face];
}

const ClosestPoint* closest_of(const FaceMeasure& measure, std::size_t point) {
  return measure.closest.empty() ? nullptr : &measure.closest[point];
}

// The vertices of all groups: each once in a group.
struct GroupVertices {
  std::vector<std::uint32_t> vertices, faces;            // and a face of the group that is there
  std::vector<std::array<std::uint32_t, 3>> of_corners;  // where each corner of a face is in these; kNone

  GroupVertices(const Mesh& mesh, const FaceMeasure& measure);
};

GroupVertices::GroupVertices(const Mesh& mesh, const FaceMeasure& measure) {
  const std::size_t face_count = mesh.triangles.size();
  of_corners.assign(face_count, {kNone, kNone, kNone});
  const auto put_all = [&](const auto& put) {
    for (std::uint32_t f = 0; f < face_count; ++f) put(measure.groups.empty() ? f : measure.groups[f], f);
  };
  std::size_t count = face_count;
  if (!measure.groups.empty()) count = *std::ranges::max_element(measure.groups) + std::size_t{1};
  const auto groups = make_rows<std::uint32_t>(count, put_all);
  std::vector<std::uint32_t> last(mesh.positions.size(), kNone);  // where each vertex is in the last group
  for (std::size_t g = 0; g < count; ++g) {
    const std::size_t begin = vertices.size();
    for (const std::uint32_t f : groups.of(g)) {
      if (is_removed(mesh.triangles[f]) || !measure.counts_at_vertices(f)) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t v = mesh.triangles[f][k];
        if (last[v] == kNone || last[v] < begin) {
          last[v] = static_cast<std::uint32_t>(vertices.size());
          vertices.push_back(v);
          faces.push_back(f);
        }
        of_corners[f][k] = last[v];
      }
    }
  }
}

}  // namespace

TexelStore::TexelStore(DistanceMap& map, const Surface& surface, const Description& description,
                       std::span<const std::uint32_t> texels)
    : map_(cleared(map, surface, description)), texels_(texels), writer_(map, description.no_value) {}

TexelStore::TexelStore(DistanceMap& map, const Description& description,
                       std::span<const std::uint32_t> texels, const SampleRange& range)
    : map_(cleared(map, description, texels.subspan(range.first, range.count))),
      texels_(texels),
      writer_(map, description.no_value) {}

void TexelStore::operator()(std::size_t first, const sites::ClosestPacket& values, std::uint32_t negative,
                            std::uint32_t unmatched) {
  const std::size_t without = writer_.store(texels_.subspan(first), values, negative);
  if (without == 0) return;
  Counter& counter = counters_[first / 1024 % counters_.size()];
  counter.without += without;
  if (unmatched == 0) return;
  counter.unmatched += static_cast<std::size_t>(std::popcount(unmatched));
  for (std::size_t i = 0; i < values.count; ++i)
    if ((unmatched >> i & 1) != 0) map_.unmatched[texels_[first + i]] = 1;
}

void TexelStore::finish() {
  std::size_t without = 0;
  map_.without_match = 0;
  for (const Counter& counter : counters_) {
    without += counter.without;
    map_.without_match += counter.unmatched;
  }
  map_.beyond_max_distance = without - map_.without_match;
  if (map_.without_match == 0 && std::ranges::count(map_.unmatched, 1) == 0) map_.unmatched.clear();
}

namespace {

// Measures the samples of the tiles.
void measure_tiles(const Surface& surface, const FaceMeasure& measure, const surface::Tiles& tiles,
                   TexelStore& texels) {
  const Array<std::uint32_t> order = order_of(tiles, measure);
  // Groups are large enough where there are many tiles that few of them are divided: each division costs what
  // it takes to start with a group.
  const std::size_t grain =
      order.empty() ? kTilesAtOnce : std::clamp<std::size_t>(order.size() / 256, kTilesAtOnce * 16, 16384);
  parallel_for(tiles.count(), grain, measure.progress, "map", [&](std::size_t begin, std::size_t end) {
    const std::unique_ptr<FaceSearch> search = measure.search();
    std::vector<Sample> samples;
    sites::ClosestPacket packet;
    const auto tile_at = [&](std::size_t place) {
      return order.empty() ? static_cast<std::uint32_t>(place) : order[place];
    };
    // Stores the values of a tile, whose samples start at this one. Returns how many there are.
    const auto store = [&](std::uint32_t tile, std::size_t first) {
      const std::size_t count = tiles.of(tile).size();
      for (std::size_t i = 0; i < count; i += sites::ClosestPacket::kSize) {
        packet.count = std::min(sites::ClosestPacket::kSize, count - i);
        std::uint32_t negative = 0, unmatched = 0;
        for (std::size_t k = 0; k < packet.count; ++k) {
          const Value value = search->value(first + i + k);
          for (int axis = 0; axis < 3; ++axis) packet.vector[axis][k] = value.vector[axis];
          packet.distance[k] = value.closest.distance;
          packet.site[k] = value.closest.site;
          packet.type[k] = value.closest.type;
          negative |= std::uint32_t{value.negative} << k;
          unmatched |= std::uint32_t{value.unmatched} << k;
        }
        texels(tiles.offsets[tile] + i, packet, negative, unmatched);
      }
      return count;
    };
    for (std::size_t place = begin, last = begin; place < end; place = last) {
      samples.clear();
      for (; last < end && samples.size() < kSamplesAtOnce; ++last) {
        const std::uint32_t tile = tile_at(last), face = tiles.faces[tile];
        for (const std::uint32_t texel : tiles.of(tile))
          samples.push_back({surface.texel_point(texel), face, normal_of(measure, face)});
      }
      search->start(samples);
      std::size_t first = 0;
      for (std::size_t i = place; i < last; ++i) first += store(tile_at(i), first);
    }
  });
  texels.finish();
}

}  // namespace

void measure_texels(const Surface& surface, const FaceMeasure& measure, DistanceMap& map) {
  const surface::Tiles tiles(surface);
  TexelStore texels(map, surface, measure.description, tiles.texels);
  measure_tiles(surface, measure, tiles, texels);
}

void measure_texels(const Surface& surface, const FaceMeasure& measure, const SampleRange& range,
                    DistanceMap& map) {
  const std::span<const std::uint32_t> faces = surface.map_faces();
  std::vector<std::uint32_t> owners(faces.size(), kNone);
  for (const std::uint32_t texel : surface.sample_texels().subspan(range.first, range.count))
    owners[texel] = faces[texel];
  const surface::Tiles tiles(surface, owners, surface::Tiles::kSide);
  TexelStore texels(map, measure.description, tiles.texels, {0, tiles.texels.size()});
  measure_tiles(surface, measure, tiles, texels);
}

std::vector<float> measure_vertices(const Mesh& mesh, const FaceMeasure& measure) {
  const GroupVertices at(mesh, measure);
  std::vector<double> values(at.vertices.size());
  parallel_for(
      values.size(), kCornersAtOnce, measure.progress, "vertices", [&](std::size_t begin, std::size_t end) {
        const std::unique_ptr<FaceSearch> search = measure.search();
        std::vector<Sample> samples;
        for (std::size_t i = begin; i < end; i += samples.size()) {
          samples.clear();
          for (std::size_t k = i; k < std::min(end, i + kSamplesAtOnce); ++k) {
            const std::uint32_t vertex = at.vertices[k], face = at.faces[k];
            samples.push_back(
                {mesh.positions[vertex], face, normal_of(measure, face), closest_of(measure, vertex)});
          }
          search->start(samples);
          for (std::size_t k = 0; k < samples.size(); ++k) {
            const Value value = search->value(k);
            const double distance = value.closest.distance;
            values[i + k] = value.closest.type == SiteType::none ? measure.description.no_value.distance
                            : value.negative                     ? -distance
                                                                 : distance;
          }
        }
      });
  // Values that only their rounding to float makes equal may have different signs.
  std::vector<double> least(mesh.positions.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      if (at.of_corners[f][k] == kNone) continue;
      double& value = least[mesh.triangles[f][k]];
      const double here = values[at.of_corners[f][k]];
      if (std::isnan(value) || std::abs(here) < std::abs(value)) value = here;
    }
  std::vector<float> result(least.size());
  std::ranges::transform(least, result.begin(), [](double value) { return static_cast<float>(value); });
  return result;
}

FacingPoints measure_points(std::span<const Vec3> points, std::span<const Vec3> normals,
                            const FaceMeasure& measure) {
  FacingPoints result;
  result.closest.resize(points.size());
  result.behind.resize(points.size());
  result.unmatched.resize(points.size());
  parallel_for(points.size(), kPointsAtOnce, measure.progress, "points",
               [&](std::size_t begin, std::size_t end) {
                 const std::unique_ptr<FaceSearch> search = measure.search();
                 for (std::size_t i = begin; i < end; ++i) {
                   Sample sample{.point = points[i], .closest = closest_of(measure, i)};
                   if (!normals.empty()) sample.normal = finite(normals[i]) ? normalized(normals[i]) : Vec3{};
                   search->start({&sample, 1});
                   const Value value = search->value(0);
                   result.closest[i] = value.closest;
                   result.behind[i] = value.negative;
                   result.unmatched[i] = value.unmatched;
                 }
               });
  return result;
}

}  // namespace sdm::map
