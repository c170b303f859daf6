#include "gpu/face_search.h"

#include <algorithm>
#include <string>

#include "core/cancellation.h"
#include "core/stopwatch.h"
#include "gpu/shaders.h"

namespace sdm::gpu {
namespace {

constexpr std::size_t kSmallest = 1024, kLargest = 1 << 20;  // points of a dispatch
constexpr std::size_t kTile = FaceSearch::kTile;
static_assert(sizeof(FaceList) == 64 && sizeof(QueryPoint) == 16);

Pipeline pipeline(Device& device, std::initializer_list<EmbeddedFile> parts) {
  std::string program;
  for (const EmbeddedFile& part : parts) program += part.bytes;
  return device.pipeline(program);
}

// As in shaders/faces.wgsl.
constexpr std::size_t kTileBytes = 96;

}  // namespace

FaceSearch::FaceSearch(std::string_view wanted)
    : device_(wanted),
      tile_balls_(pipeline(device_, {kFacesWgsl, kNearestFirstWgsl, kTileBallsWgsl})),
      tiles_together_(pipeline(device_, {kFacesWgsl, kClosestTilesWgsl})),
      points_alone_(pipeline(device_, {kFacesWgsl, kNearestFirstWgsl, kClosestFacesWgsl})),
      tile_count_(device_.buffer(4 * sizeof(std::uint32_t), Device::Use::uniform, "constants")) {}

const SitesOnDevice& FaceSearch::place(const sites::SitesData& sites) {
  auto present =
      std::ranges::find(kept_, sites.shape_number, [](const auto& each) { return each->shape_number; });
  if (present == kept_.end()) {
    // Memory of the one that was not used for longest comes first.
    if (kept_.size() == kKept) kept_.pop_back();
    kept_.push_back(std::make_unique<SitesOnDevice>(device_, sites));
    present = kept_.end() - 1;
  }
  std::rotate(kept_.begin(), present, present + 1);
  return *kept_.front();
}

void FaceSearch::reserve(std::size_t points) {
  if (points <= room_) return;
  room_ = 0;
  points_.reset();
  results_.reset();
  read_back_.reset();
  tiles_.reset();
  points_ = device_.buffer(points * sizeof(QueryPoint), Device::Use::read, "points");
  results_ = device_.buffer(points * sizeof(FaceList), Device::Use::write, "results");
  read_back_ = device_.buffer(points * sizeof(FaceList), Device::Use::read_back, "results");
  tiles_ = device_.buffer(points / kTile * kTileBytes, Device::Use::write, "tiles");
  room_ = points;
}

// Points that fill tiles.
void FaceSearch::search(const SitesOnDevice& sites, std::span<const QueryPoint> points,
                        std::span<FaceList> found, SearchTimes& times) {
  reserve(points.size());
  const auto tiles = static_cast<std::uint32_t>(points.size() / kTile);
  const std::uint32_t count[4] = {tiles};
  device_.write(tile_count_, std::as_bytes(std::span(count)));
  device_.write(points_, std::as_bytes(points));
  using Binding = Device::Binding;
  const Binding of_sites[] = {{0, &sites.errors}, {1, &sites.boxes}, {2, &sites.leaves}, {3, &sites.faces}};
  const auto bind = [&](const Pipeline& pipeline, std::initializer_list<Binding> others) {
    std::vector<Binding> all(std::begin(of_sites), std::end(of_sites));
    all.insert(all.end(), others);
    return device_.bind(pipeline, all);
  };
  const BindGroup balls = bind(tile_balls_, {{4, &points_}, {6, &tiles_}, {7, &tile_count_}}),
                  together = bind(tiles_together_, {{4, &points_}, {5, &results_}, {6, &tiles_}}),
                  alone = bind(points_alone_, {{4, &points_}, {5, &results_}, {6, &tiles_}});
  const Device::Step steps[] = {{&tile_balls_, &balls, (tiles + 63) / 64},
                                {&tiles_together_, &together, tiles},
                                {&points_alone_, &alone, tiles}};
  device_.run(steps, results_, read_back_, std::as_writable_bytes(found));
  times.dispatches += 1;
}

void FaceSearch::find(const sites::SitesData& sites, std::span<const QueryPoint> points,
                      std::span<FaceList> found, SearchTimes& times) {
  Stopwatch watch;
  const SitesOnDevice& on_device = place(sites);
  times.upload_ms += watch.lap();
  const std::size_t permitted =
      std::clamp<std::size_t>(device_.most_bytes() / sizeof(FaceList) / kTile * kTile, kTile, kLargest);
  for (std::size_t done = 0; done < points.size();) {
    poll();
    const std::size_t count = std::min({points.size() - done, dispatch_, permitted});
    search(on_device, points.subspan(done, count), found.subspan(done, count), times);
    const double ms = watch.lap();
    times.search_ms += ms;
    if (ms > 30 && dispatch_ > kSmallest) dispatch_ /= 2;
    if (ms < 10 && count == dispatch_ && dispatch_ < kLargest) dispatch_ *= 2;
    done += count;
  }
}

}  // namespace sdm::gpu
