#include <sdm/error.h>
#include <sdm/rays.h>

#include <cmath>
#include <new>
#include <string>

#include "core/memory.h"
#include "core/parallel.h"
#include "mesh/validate.h"
#include "rays/trace.h"

namespace sdm {
namespace {

constexpr std::size_t kGrain = 256;

void validate(std::span<const Ray> rays) {
  using mesh::kMaxCoordinate;
  constexpr double kMinDirection = mesh::kMinSize;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto fail = [&](const char* what) { throw Error("ray " + std::to_string(i) + " has " + what); };
    double largest = 0;
    for (int k = 0; k < 3; ++k) {
      if (!(std::abs(rays[i].origin[k]) <= kMaxCoordinate))
        fail("an origin with a coordinate that is NaN or beyond 1e37");
      if (!(std::abs(rays[i].direction[k]) <= kMaxCoordinate))
        fail("a direction with a component that is NaN or beyond 1e37");
      largest = std::max(largest, std::abs(rays[i].direction[k]));
    }
    if (largest < kMinDirection) fail("a direction without a component of at least 1e-30");
    if (!(rays[i].t_min >= 0)) fail("a t_min that is negative or NaN");
    if (std::isnan(rays[i].t_max)) fail("a t_max that is NaN");
  }
}

template <class Result, class Trace>
std::vector<Result> trace(std::span<const Ray> rays, const Progress& progress, const Trace& trace_some) try {
  validate(rays);
  std::vector<Result> results(rays.size());
  parallel_for(rays.size(), kGrain, progress, "rays", [&](std::size_t begin, std::size_t end) {
    thread_local rays::Scratch scratch;
    trace_some(rays.subspan(begin, end - begin), scratch, results.data() + begin);
  });
  return results;
} catch (const std::bad_alloc&) {
  throw out_of_memory("rays");
}

}  // namespace

std::vector<RayHit> first_hits(const Sites& sites, std::span<const Ray> rays, const RayOptions& options) {
  return trace<RayHit>(rays, options.progress,
                       [&](std::span<const Ray> some, rays::Scratch& scratch, RayHit* hits) {
                         rays::first_hits(internals(sites), some, scratch, hits);
                       });
}

std::vector<std::uint8_t> occluded(const Sites& sites, std::span<const Ray> rays, const RayOptions& options) {
  return trace<std::uint8_t>(rays, options.progress,
                             [&](std::span<const Ray> some, rays::Scratch& scratch, std::uint8_t* result) {
                               rays::occluded(internals(sites), some, scratch, result);
                             });
}

}  // namespace sdm
