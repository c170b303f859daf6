#include "surface/edit_samples.h"

#include <algorithm>

#include "core/memory.h"
#include "geometry/spatial_order.h"
#include "surface/sample_order.h"
#include "surface/surface_data.h"

namespace sdm::surface {

void edit_samples(SurfaceData& s, std::span<const std::uint8_t> removed_faces,
                  std::span<const std::uint32_t> added, std::uint32_t texels_before) {
  const std::size_t before = s.samples.size(), packets = (before + kPacket - 1) / kPacket;
  const auto end_of = [&](std::size_t packet) { return std::min(before, (packet + 1) * kPacket); };
  const auto is_removed = [&](std::size_t i) { return removed_faces[s.sample_faces[i]] != 0; };

  // Where a sample that stays is now.
  const auto without = std::span<const std::uint32_t>(s.map_faces).subspan(s.texels());
  const auto index_of = [&](std::size_t i) {
    if (s.samples[i] < texels_before) return s.samples[i];
    const auto place = std::ranges::lower_bound(without, s.sample_faces[i]) - without.begin();
    return s.texels() + static_cast<std::uint32_t>(place);
  };

  std::vector<std::uint32_t> open;  // packets that lose a sample
  std::size_t removed = 0;
  for (std::size_t p = 0; p < packets; ++p) {
    std::size_t of_packet = 0;
    for (std::size_t i = p * kPacket; i < end_of(p); ++i) of_packet += is_removed(i);
    if (of_packet > 0) open.push_back(static_cast<std::uint32_t>(p));
    removed += of_packet;
  }
  if (removed == 0 && added.empty()) return;
  // What is not full at the end, or beyond the new end, is distributed as well.
  const std::size_t after = before - removed + added.size();
  const std::size_t full = std::min(before, after) / kPacket;
  while (!open.empty() && open.back() >= full) open.pop_back();
  for (std::size_t p = full; p < packets; ++p) open.push_back(static_cast<std::uint32_t>(p));

  std::vector<std::uint32_t> texels;
  for (const std::uint32_t p : open)
    for (std::size_t i = p * kPacket; i < end_of(p); ++i)
      if (!is_removed(i)) texels.push_back(index_of(i));
  texels.insert(texels.end(), added.begin(), added.end());
  std::vector<Vec3> points(texels.size());
  for (std::size_t i = 0; i < texels.size(); ++i)
    points[i] = s.texel_point(s.map_faces[texels[i]], texels[i]);
  const std::vector<std::uint32_t> order = spatial_order(points);

  reserve_for(s.samples, after);
  reserve_for(s.sample_faces, after);
  for (std::size_t i = 0; i < before; ++i)  // from here on, nothing fails
    if (!is_removed(i)) s.samples[i] = index_of(i);
  s.samples.resize(after);
  s.sample_faces.resize(after);
  std::size_t next = 0;
  const auto fill = [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      s.samples[i] = texels[order[next++]];
      s.sample_faces[i] = s.map_faces[s.samples[i]];
    }
  };
  for (const std::uint32_t p : open)
    if (p < full) fill(p * kPacket, (p + 1) * kPacket);
  fill(full * kPacket, after);
}

}  // namespace sdm::surface
