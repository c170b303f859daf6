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

Pipeline pipeline(Device& device, std::initializer_list<EmbeddedFile> parts) {
  std::string program;
  for (const EmbeddedFile& part : parts) program += part.bytes;
  return device.pipeline(program);
}

// As in the shaders.
constexpr std::size_t kTileBytes = 96;
struct PartOfMap {
  std::uint32_t tiles = 0, first = 0, count = 0, has_distances = 0;
};

}  // namespace

FaceSearch::FaceSearch(std::string_view wanted)
    : device_(wanted),
      samples_(pipeline(device_, {kPartWgsl, kPlaceSamplesWgsl})),
      tile_balls_(pipeline(device_, {kFacesWgsl, kNearestFirstWgsl, kPartWgsl, kTileBallsWgsl})),
      tiles_together_(pipeline(device_, {kFacesWgsl, kClosestTilesWgsl})),
      points_alone_(pipeline(device_, {kFacesWgsl, kNearestFirstWgsl, kClosestFacesWgsl})),
      distances_(pipeline(device_, {kFacesWgsl, kNearestFirstWgsl, kPartWgsl, kMapDistancesWgsl})),
      part_(device_.buffer(sizeof(PartOfMap), Device::Use::uniform, "constants")) {}

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

BindGroup FaceSearch::bind(const Pipeline& pipeline, const SitesOnDevice::Part& part,
                           std::initializer_list<Device::Binding> others) {
  std::vector<Device::Binding> all{{1, &part.boxes}, {2, &part.leaves}, {3, &part.faces}};
  all.insert(all.end(), others);
  return device_.bind(pipeline, all);
}

template <class Run>
void FaceSearch::search(const SitesOnDevice& sites, const SitesOnDevice::Part& part, std::size_t points,
                        const Run& run) {
  const auto tiles = static_cast<std::uint32_t>(points / kTile);
  const Device::Binding errors{0, &sites.errors}, at{4, &points_}, results{5, &results_}, balls{6, &tiles_};
  const BindGroup of_balls = bind(tile_balls_, part, {errors, at, balls, {7, &part_}}),
                  together = bind(tiles_together_, part, {errors, at, results, balls}),
                  alone = bind(points_alone_, part, {errors, at, results, balls});
  run(std::vector<Device::Step>{{&tile_balls_, &of_balls, (tiles + 63) / 64},
                                {&tiles_together_, &together, tiles},
                                {&points_alone_, &alone, tiles}});
}

template <class Search>
void FaceSearch::in_dispatches(std::size_t points, SearchTimes& times, const Search& search) {
  Stopwatch watch;
  const std::size_t permitted =
      std::clamp<std::size_t>(device_.most_bytes() / sizeof(FaceList) / kTile * kTile, kTile, kLargest);
  for (std::size_t done = 0; done < points;) {
    poll();
    const std::size_t count = std::min({points - done, dispatch_, permitted});
    reserve(count);
    search(done, count);
    times.dispatches += 1;
    const double ms = watch.lap();
    times.search_ms += ms;
    if (ms > 30 && dispatch_ > kSmallest) dispatch_ /= 2;
    if (ms < 10 && count == dispatch_ && dispatch_ < kLargest) dispatch_ *= 2;
    done += count;
  }
}

void FaceSearch::find(const sites::SitesData& sites, std::span<const QueryPoint> points, FaceLists& found,
                      SearchTimes& times) {
  Stopwatch watch;
  const SitesOnDevice& on_device = place(sites);
  times.upload_ms += watch.lap();
  found.points = points.size();
  found.lists.resize(on_device.parts.size() * points.size());
  found.first.clear();
  for (const SitesOnDevice::Part& part : on_device.parts) found.first.push_back(part.first);
  in_dispatches(points.size(), times, [&](std::size_t first, std::size_t count) {
    const PartOfMap constants{.tiles = static_cast<std::uint32_t>(count / kTile)};
    device_.write(part_, std::as_bytes(std::span(&constants, 1)));
    device_.write(points_, std::as_bytes(points.subspan(first, count)));
    for (std::size_t p = 0; p < on_device.parts.size(); ++p)
      search(on_device, on_device.parts[p], count, [&](std::span<const Device::Step> steps) {
        const std::span to = std::span(found.lists).subspan(p * points.size() + first, count);
        device_.run(steps, results_, read_back_, std::as_writable_bytes(to));
      });
  });
}

void FaceSearch::measure(const sites::SitesData& sites, const SamplesOnDevice& samples, std::size_t count,
                         const Buffer& distances) {
  const SitesOnDevice& on_device = place(sites);
  SearchTimes times;
  in_dispatches((count + kTile - 1) / kTile * kTile, times, [&](std::size_t first, std::size_t size) {
    PartOfMap constants{.tiles = static_cast<std::uint32_t>(size / kTile),
                        .first = static_cast<std::uint32_t>(first),
                        .count = static_cast<std::uint32_t>(std::min(size, count - first))};
    const Device::Binding of_samples[] = {
        {0, &samples.samples}, {1, &samples.positions}, {4, &points_}, {7, &part_}};
    const BindGroup placing = device_.bind(samples_, of_samples);
    for (const SitesOnDevice::Part& part : on_device.parts) {
      device_.write(part_, std::as_bytes(std::span(&constants, 1)));
      search(on_device, part, size, [&](std::vector<Device::Step> steps) {
        const BindGroup measuring =
            bind(distances_, part, {{4, &points_}, {5, &results_}, {6, &distances}, {7, &part_}});
        steps.insert(steps.begin(), {&samples_, &placing, constants.tiles});
        steps.push_back({&distances_, &measuring, constants.tiles});
        device_.run(steps);
      });
      constants.has_distances = 1;
    }
  });
}

}  // namespace sdm::gpu
