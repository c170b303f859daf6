#include <sdm/bake_files.h>
#include <sdm/error.h>

#include <algorithm>
#include <bit>
#include <new>

#include "core/memory.h"
#include "io/image/exr_planes.h"

namespace sdm {
namespace {

std::size_t texels_of(const TexelPlane& plane) {
  const std::size_t count = plane.numbers.empty() ? plane.values.size() : plane.numbers.size();
  return plane.component < plane.components && count % plane.components == 0 ? count / plane.components : 0;
}

}  // namespace

void write_exr(const std::filesystem::path& file, std::uint32_t resolution,
               std::span<const TexelPlane> planes,
               const std::vector<std::pair<std::string, std::string>>& attributes) try {
  std::vector<TexelPlane> sorted(planes.begin(), planes.end());
  std::ranges::sort(sorted, {}, &TexelPlane::name);
  const std::size_t texels = planes.empty() ? 0 : texels_of(planes[0]);
  if (resolution == 0 || texels == 0 || texels % resolution != 0 ||
      std::ranges::any_of(sorted, [&](const TexelPlane& plane) { return texels_of(plane) != texels; }))
    throw Error("cannot write " + file.string() + ": its planes are not the same whole rows of texels");
  std::vector<io::ExrPlane> described;
  for (const TexelPlane& plane : sorted) described.push_back({plane.name, !plane.numbers.empty()});
  io::write_planes(file, resolution, static_cast<std::uint32_t>(texels / resolution), described,
                   {"baked texture", attributes}, [&](std::uint32_t y, std::span<std::uint32_t> row) {
                     for (std::size_t p = 0; p < sorted.size(); ++p) {
                       const TexelPlane& plane = sorted[p];
                       const std::size_t first = std::size_t{y} * resolution;
                       for (std::size_t x = 0; x < resolution; ++x) {
                         const std::size_t at = (first + x) * plane.components + plane.component;
                         row[p * resolution + x] = plane.numbers.empty()
                                                       ? std::bit_cast<std::uint32_t>(plane.values[at])
                                                       : plane.numbers[at];
                       }
                     }
                   });
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

}  // namespace sdm
