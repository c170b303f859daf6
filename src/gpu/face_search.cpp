#include "gpu/face_search.h"

#include <algorithm>

#include "core/cancellation.h"
#include "core/stopwatch.h"
#include "gpu/shaders.h"

namespace sdm::gpu {
namespace {

constexpr std::size_t kWorkgroup = 64, kSmallest = 1024, kLargest = 1 << 20;  // points of a dispatch
static_assert(sizeof(FaceList) == 64 && sizeof(QueryPoint) == 16);

}  // namespace

FaceSearch::FaceSearch(std::string_view wanted)
    : device_(wanted), pipeline_(device_.pipeline(kClosestFacesWgsl.bytes)) {}

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
  points_.reset(), results_.reset(), read_back_.reset();
  points_ = device_.buffer(points * sizeof(QueryPoint), Device::Use::read, "points");
  results_ = device_.buffer(points * sizeof(FaceList), Device::Use::write, "results");
  read_back_ = device_.buffer(points * sizeof(FaceList), Device::Use::read_back, "results");
  room_ = points;
}

void FaceSearch::find(const sites::SitesData& sites, std::span<const QueryPoint> points,
                      std::span<FaceList> found, SearchTimes& times) {
  Stopwatch watch;
  const SitesOnDevice& on_device = place(sites);
  times.upload_ms += watch.lap();
  const std::size_t permitted = std::clamp<std::size_t>(
      device_.most_bytes() / sizeof(FaceList) / kWorkgroup * kWorkgroup, kWorkgroup, kLargest);
  for (std::size_t done = 0; done < points.size();) {
    poll();
    const std::size_t count = std::min({points.size() - done, dispatch_, permitted});
    reserve((count + kWorkgroup - 1) / kWorkgroup * kWorkgroup);
    device_.write(points_, std::as_bytes(points.subspan(done, count)));
    const Buffer* const buffers[] = {&on_device.errors, &on_device.nodes, &on_device.leaves,
                                     &on_device.faces,  &points_,         &results_};
    const BindGroup group = device_.bind(pipeline_, buffers);
    device_.run(pipeline_, group, static_cast<std::uint32_t>((count + kWorkgroup - 1) / kWorkgroup), results_,
                read_back_, std::as_writable_bytes(found.subspan(done, count)));
    const double ms = watch.lap();
    times.search_ms += ms;
    times.dispatches += 1;
    if (ms > 30 && dispatch_ > kSmallest) dispatch_ /= 2;
    if (ms < 10 && count == dispatch_ && dispatch_ < kLargest) dispatch_ *= 2;
    done += count;
  }
}

}  // namespace sdm::gpu
