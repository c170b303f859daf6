#include "closest/scattered.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "closest/blocks.h"
#include "closest/closest_points.h"
#include "closest/single_point.h"
#include "core/parallel.h"
#include "geometry/spatial_order.h"
#include "geometry/vec.h"

namespace sdm::closest {
namespace {

constexpr std::size_t kPacketPoints = SinglePointMemory::kPacket;
// Fewer points are searched as packets without a look at samples of them.
constexpr std::size_t kEnoughToSample = 8192;
constexpr std::size_t kSamples = 8;

// The part of space in which the order tells points apart: one point far from O2 must not leave all others in
// one cell.
Box around(const UnitFrame& frame) {
  constexpr double kSizes = 8;
  const double half = kSizes / frame.scale;
  const Vec3 size{half, half, half};
  return {frame.origin - size, frame.origin + size};
}

std::vector<std::uint32_t> given_order(std::size_t count) {
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  return order;
}

// The sum of the sizes of packets.
double size_of_packets(std::span<const Vec3> points, std::span<const std::uint32_t> order) {
  double sum = 0;
  for (std::size_t i = 0; i < order.size(); i += kPacketPoints) {
    Box box;
    for (const std::uint32_t p : order.subspan(i, std::min(kPacketPoints, order.size() - i)))
      extend(box, points[p]);
    sum += diagonal(box);
  }
  return sum;
}

// Points as they are searched.
struct Ordered {
  std::vector<std::uint32_t> order;
  bool given;  ///< as they were
};

// Whether points that are given one after another are near each other, as the samples of maps are: packets of
// them are hardly larger than those along a curve through the same points.
bool in_order(std::span<const Vec3> points, const Box& box) {
  constexpr std::size_t kRun = 1024;
  constexpr double kHardlyLarger = 1.2;
  double given = 0, along_curve = 0;
  for (std::size_t s = 0; s < kSamples; ++s) {
    const std::span<const Vec3> run = points.subspan(s * (points.size() - kRun) / (kSamples - 1), kRun);
    given += size_of_packets(run, given_order(kRun));
    along_curve += size_of_packets(run, morton_order(run, box));
  }
  return given <= kHardlyLarger * along_curve;
}

// The points, those outside of the box moved towards its centre onto its surface: what is far away is near to
// each other if it is so by direction.
std::vector<Vec3> projected(std::span<const Vec3> points, const Box& box) {
  const Vec3 centre = 0.5 * (box.lower + box.upper);
  const double reach = box.upper[0] - centre[0];
  std::vector<Vec3> result(points.begin(), points.end());
  for (Vec3& p : result) {
    const Vec3 from = p - centre;
    const double largest = std::max({std::abs(from[0]), std::abs(from[1]), std::abs(from[2])});
    if (largest > reach && largest < kInfinity) p = centre + reach / largest * from;
  }
  return result;
}

Ordered order_of(std::span<const Vec3> points, const Box& box) {
  if (points.size() <= kPacketPoints || (points.size() >= kEnoughToSample && in_order(points, box)))
    return {given_order(points.size()), true};
  const auto inside = [&](const Vec3& p) {
    for (std::size_t k = 0; k < 3; ++k)
      if (!(p[k] >= box.lower[k] && p[k] <= box.upper[k])) return false;
    return true;
  };
  if (std::ranges::all_of(points, inside)) return {morton_order(points, box), false};
  return {morton_order(projected(points, box), box), false};
}

// Divides runs of an order as spatial_order() does: groups cost less if they are as small as can be.
void divide_runs(std::span<const Vec3> points, std::span<std::uint32_t> order) {
  constexpr std::size_t kRun = 4096;
  parallel_for((order.size() + kRun - 1) / kRun, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      const std::span<std::uint32_t> run = order.subspan(kRun * r, std::min(kRun, order.size() - kRun * r));
      const std::vector<std::uint32_t> before(run.begin(), run.end());
      std::vector<Vec3> at(run.size());
      for (std::size_t i = 0; i < run.size(); ++i) at[i] = points[before[i]];
      const std::vector<std::uint32_t> divided = spatial_order(at);
      for (std::size_t i = 0; i < run.size(); ++i) run[i] = before[divided[i]];
    }
  });
}

// Whether groups cost less than packets, by samples: where most points of a packet are near to the same few
// leaves, and not far away from all. (Measured.)
bool better_in_groups(const sites::SitesData& sites, std::span<const Vec3> points,
                      std::span<const std::uint32_t> order, double max_distance,
                      std::span<ClosestPoint> scratch) {
  constexpr std::size_t kRun = 128, kMostLeaves = 26;
  if (points.size() < kEnoughToSample) return false;
  PacketWork work;
  for (std::size_t s = 0; s < kSamples; ++s) {
    const std::size_t first = s * (points.size() - kRun) / (kSamples - 1);
    const PacketWork run = closest_of_each(sites, points, order.subspan(first, kRun), max_distance, scratch);
    work.leaves += run.leaves;
    work.pairs += run.pairs;
    work.far += run.far;
  }
  if (2 * work.far > kSamples * kRun) return false;
  return 2 * work.pairs >= kPacketPoints * work.leaves &&
         work.leaves <= kMostLeaves * kSamples * kRun / kPacketPoints;
}

}  // namespace

void find_scattered(const sites::SitesData& sites, std::span<const Vec3> points, double max_distance,
                    const Progress& progress, std::span<ClosestPoint> found) {
  auto [order, given] = order_of(points, around(sites.frame));
  if (better_in_groups(sites, points, order, max_distance, found)) {
    if (!given) divide_runs(points, order);
    const auto in_groups = [&](std::span<const Vec3> block, const sites::ClosestSink& sink) {
      closest_points(sites, block, max_distance, sink);
    };
    return find_in_blocks(sites, points, order, in_groups, progress, found);
  }
  for_each_block(points.size(), progress, "closest points",
                 [&, &order = order](std::size_t begin, std::size_t end) {
                   const std::span block(order.data() + begin, end - begin);
                   closest_of_each(sites, points, block, max_distance, found);
                   for (const std::uint32_t i : block) {
                     ClosestPoint& c = found[i];
                     if (c.type == SiteType::none) continue;
                     c.point = points[i] + (c.point - points[i]);  // where the vector of a map ends
                     c.face = sites.face_of(c.type, c.site);
                   }
                 });
}

void find_in_blocks(const sites::SitesData& sites, std::span<const Vec3> points,
                    std::span<const std::uint32_t> order, const BlockSearch& search, const Progress& progress,
                    std::span<ClosestPoint> found) {
  for_each_block(points.size(), progress, "closest points", [&](std::size_t begin, std::size_t end) {
    std::vector<Vec3> batch(end - begin);
    for (std::size_t i = begin; i < end; ++i) batch[i - begin] = points[order[i]];
    search(batch, [&](std::size_t first, const sites::ClosestPacket& closest) {
      for (std::size_t i = 0; i < closest.count; ++i) {
        ClosestPoint& c = found[order[begin + first + i]];
        c = closest.get(i, batch[first + i]);
        if (c.type != SiteType::none) c.face = sites.face_of(c.type, c.site);
      }
    });
  });
}

}  // namespace sdm::closest
