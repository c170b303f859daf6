#include "sites/check_numbers.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "core/parallel.h"
#include "tree/check_tree.h"

namespace sdm::sites {
namespace {

// The limits of the 32-bit words of a record, as the bits of positive numbers, whose order is that of the
// numbers; those of infinity and NaN are larger than those of all others.
constexpr std::uint32_t kMagnitude = 0x7FFFFFFF;
constexpr auto kReach = std::bit_cast<std::uint32_t>(kUnitReach);
constexpr auto kUnit = std::bit_cast<std::uint32_t>(1.001f);
constexpr auto kInfinite = std::bit_cast<std::uint32_t>(std::numeric_limits<float>::infinity());
constexpr std::uint32_t kAny = kMagnitude;  // an index

// A normal and an offset, four times; a wall that encloses nothing is infinitely far away.
constexpr std::uint32_t kFaceLimits[] = {kUnit, kUnit, kUnit, kReach,    kUnit, kUnit, kUnit, kInfinite,
                                         kUnit, kUnit, kUnit, kInfinite, kUnit, kUnit, kUnit, kInfinite};
// Start, direction, length, two walls and the edge.
constexpr std::uint32_t kEdgeLimits[] = {kReach, kReach, kReach, kUnit, kUnit, kUnit, kReach, kUnit,
                                         kUnit,  kUnit,  kReach, kUnit, kUnit, kUnit, kReach, kAny};
// Point, four rays and the vertex.
constexpr std::uint32_t kVertexLimits[] = {kReach, kReach, kReach, kUnit, kUnit, kUnit, kUnit, kUnit,
                                           kUnit,  kUnit,  kUnit,  kUnit, kUnit, kUnit, kUnit, kAny};

template <class Record>
bool are_limited(std::span<const Record> records, const std::uint32_t (&limits)[16]) {
  static_assert(sizeof(Record) == sizeof limits);
  std::int32_t most[16];
  std::memcpy(most, limits, sizeof most);
  std::int32_t beyond[16] = {};
  for (const Record& record : records) {
    std::int32_t words[16];
    std::memcpy(words, &record, sizeof words);
    for (int k = 0; k < 16; ++k) beyond[k] |= (words[k] & std::int32_t{kMagnitude}) > most[k] ? 1 : 0;
  }
  return std::ranges::count(beyond, 0) == 16;
}

// Lanes that no face uses hold what the vertices at 0 give.
bool have_limits(const Regions& regions) {
  if (!(regions.largest_radius <= kUnitReach)) return false;
  for (std::size_t leaf = 0; leaf < regions.bounds.size(); ++leaf) {
    const FaceBounds& bounds = regions.bounds[leaf];
    const std::uint32_t count = regions.leaves[leaf + 1] - regions.leaves[leaf];
    for (std::uint32_t i = 0; i < count; ++i) {
      for (int k = 0; k < 3; ++k)
        if (!(std::abs(bounds.centre[k][i]) <= kUnitReach && std::abs(bounds.normal[k][i]) <= 1.001f))
          return false;
      if (!(bounds.radius[i] >= 0 && bounds.radius[i] <= regions.largest_radius && bounds.slope[i] >= 0 &&
            bounds.slope[i] <= FaceBounds::kOpen))
        return false;
    }
  }
  return true;
}

// Whether the points of the regions are those of the mesh, to the bit; `placed`: see place().
bool are_at(const Regions& regions, const UnitFrame& frame, std::span<const Vec3> placed) {
  bool same = true;
  for (std::size_t v = 0; v < placed.size(); ++v) {
    const Vec3 unit = frame.to_unit(placed[v]);
    for (int k = 0; k < 3; ++k) {
      const auto x = static_cast<float>(unit[k]);
      same &= regions.points[v].point[k] == x && regions.vertices[v].point[k] == x;
    }
  }
  for (std::size_t e = 0; e < regions.edges.size(); ++e) {
    const UnitVertex& start = regions.points[regions.places.edges[e].corners[0]];
    for (int k = 0; k < 3; ++k) same &= regions.edges[e].start[k] == start.point[k];
  }
  return same;
}

std::span<const double> numbers_of(const Array<Vec3>& vectors) {
  return {vectors.empty() ? nullptr : vectors[0].data(), 3 * vectors.size()};
}

}  // namespace

bool are_within(std::span<const float> numbers, float limit) {
  unsigned beyond = 0;
  for (const float x : numbers) beyond |= std::abs(x) <= limit ? 0 : 1;
  return beyond == 0;
}
bool are_within(std::span<const double> numbers, double limit) {
  unsigned beyond = 0;
  for (const double x : numbers) beyond |= std::abs(x) <= limit ? 0 : 1;
  return beyond == 0;
}

bool have_valid_numbers(const SitesData& s) {
  const Regions& r = s.regions;
  bool boxes = false, points = false, regions = false, normals = false;
  parallel_invoke(
      [&] {
        std::vector<Vec3> placed;
        place(r, s.mesh.positions, placed);
        points = are_at(r, s.frame, placed);
        std::vector<tree::FloatBox> leaves;
        find_leaf_boxes(r, s.frame, placed, leaves);
        boxes = tree::have_valid_boxes(s.tree, leaves, kUnitReach) && tree::have_same_boxes(s.wide, s.tree);
      },
      [&] {
        regions = have_limits(r) && are_limited(std::span<const FaceRegion>(r.faces), kFaceLimits) &&
                  are_limited(std::span<const EdgeRegion>(r.edges), kEdgeLimits) &&
                  are_limited(std::span<const VertexRegion>(r.vertices), kVertexLimits);
        // Angles add up to at most a straight one a face.
        normals = are_within(numbers_of(s.normals.face), 1.001) &&
                  are_within(numbers_of(s.normals.vertex), 4.0 * static_cast<double>(r.faces.size()));
      });
  return boxes && points && regions && normals;
}

}  // namespace sdm::sites
