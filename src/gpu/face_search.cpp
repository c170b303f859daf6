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

Pipeline pipeline(Device& device, const EmbeddedFile& program) {
  return device.pipeline(std::string(kFacesWgsl.bytes) + std::string(program.bytes));
}

}  // namespace

FaceSearch::FaceSearch(std::string_view wanted)
    : device_(wanted),
      tiles_together_(pipeline(device_, kClosestTilesWgsl)),
      points_alone_(pipeline(device_, kClosestFacesWgsl)) {}

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
  tiles_ = device_.buffer(points / kTile * sizeof(std::uint32_t), Device::Use::read, "tiles");
  room_ = points;
}

// Points that fill tiles.
void FaceSearch::search(const SitesOnDevice& sites, std::span<const QueryPoint> points,
                        std::span<FaceList> found, SearchTimes& times) {
  reserve(points.size());
  device_.write(points_, std::as_bytes(points));
  const Buffer* const buffers[] = {&sites.errors, &sites.boxes, &sites.leaves, &sites.faces,
                                   &points_,      &results_,    &tiles_};
  device_.run(tiles_together_, device_.bind(tiles_together_, std::span(buffers).first(6)),
              static_cast<std::uint32_t>(points.size() / kTile), results_, read_back_,
              std::as_writable_bytes(found));
  times.dispatches += 1;
  std::vector<std::uint32_t> alone;
  for (std::size_t i = 0; i < found.size(); i += kTile)
    if (found[i].alone()) alone.push_back(static_cast<std::uint32_t>(i / kTile));
  if (alone.empty()) return;
  times.alone += kTile * alone.size();
  device_.write(tiles_, std::as_bytes(std::span(alone)));
  device_.run(points_alone_, device_.bind(points_alone_, buffers), static_cast<std::uint32_t>(alone.size()),
              results_, read_back_, std::as_writable_bytes(found));
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
