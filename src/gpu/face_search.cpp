#include "gpu/face_search.h"

#include <algorithm>

#include "core/cancellation.h"
#include "core/lazy/unique_number.h"
#include "core/stopwatch.h"
#include "gpu/shaders.h"

namespace sdm::gpu {
namespace {

constexpr std::size_t kSmallest = 1024, kLargest = 1 << 20;  // points of a dispatch
constexpr std::size_t kTile = FaceSearch::kTile;

constexpr std::size_t kTileBytes = 96;  // as in shaders/faces.wgsl

}  // namespace

FaceSearch::FaceSearch(std::string_view wanted)
    : device_(wanted),
      samples_(device_.pipeline({kPartWgsl, kPlaceSamplesWgsl})),
      tile_balls_(device_.pipeline({kFacesWgsl, kNearestFirstWgsl, kPartWgsl, kTileBallsWgsl})),
      tiles_together_(device_.pipeline({kFacesWgsl, kClosestTilesWgsl})),
      points_alone_(device_.pipeline({kFacesWgsl, kNearestFirstWgsl, kClosestFacesWgsl})),
      distances_(device_.pipeline({kFacesWgsl, kNearestFirstWgsl, kPartWgsl, kMapDistancesWgsl})),
      part_(device_.buffer(sizeof(PartOfMap), Device::Use::uniform, "constants")) {}

SitesOnDevice& FaceSearch::place(const sites::SitesData& sites) {
  auto present =
      std::ranges::find(kept_, sites.shape_number, [](const auto& each) { return each->shape_number; });
  if (present == kept_.end()) {
    present = std::ranges::find_if(kept_, [&](const auto& each) { return each->has_tree_of(sites); });
    if (present != kept_.end()) {
      refit(**present, sites.mesh.positions, sites.frame);
      (*present)->shape_number = sites.shape_number;
    }
  }
  if (present == kept_.end()) {
    // Memory of the one that was not used for longest comes first.
    if (kept_.size() == kKept) kept_.pop_back();
    kept_.push_back(std::make_unique<SitesOnDevice>(device_, sites));
    present = kept_.end() - 1;
  }
  std::rotate(kept_.begin(), present, present + 1);
  return *kept_.front();
}

void FaceSearch::refit(SitesOnDevice& sites, std::span<const Vec3> positions, const UnitFrame& moved) {
  if (!refit_) refit_.emplace(device_);
  sites.shape_number = unique_number();  // of no SitesData
  sites.refit(device_, *refit_, positions, moved);
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

void FaceSearch::measure(const SitesOnDevice& sites, const SamplesOnDevice& samples, std::size_t count,
                         const Buffer& distances, const Buffer& closest) {
  if (closest && !closest_)
    closest_ = device_.pipeline({kFacesWgsl, kNearestFirstWgsl, kPartWgsl, kFaceSitesWgsl, kMapClosestWgsl});
  SearchTimes times;
  in_dispatches((count + kTile - 1) / kTile * kTile, times, [&](std::size_t first, std::size_t size) {
    PartOfMap constants{.tiles = static_cast<std::uint32_t>(size / kTile),
                        .first = static_cast<std::uint32_t>(first),
                        .count = static_cast<std::uint32_t>(std::min(size, count - first))};
    const Device::Binding at{4, &points_}, lists{5, &results_}, constants_at{7, &part_};
    const Device::Binding of_samples[] = {{0, &samples.samples}, {1, &samples.positions}, at, constants_at};
    const BindGroup placing = device_.bind(samples_, of_samples);
    for (const SitesOnDevice::Part& part : sites.parts) {
      device_.write(part_, std::as_bytes(std::span(&constants, 1)));
      search(sites, part, size, [&](std::vector<Device::Step> steps) {
        const BindGroup measuring = bind(distances_, part, {at, lists, {6, &distances}, constants_at});
        steps.insert(steps.begin(), {&samples_, &placing, constants.tiles});
        steps.push_back({&distances_, &measuring, constants.tiles});
        BindGroup closing;
        if (closest) {
          closing = bind(closest_, part, {at, lists, {6, &closest}, constants_at, {8, &part.face_sites}});
          steps.push_back({&closest_, &closing, constants.tiles});
        }
        device_.run(steps);
      });
      constants.has_distances = 1;
    }
  });
}

}  // namespace sdm::gpu
