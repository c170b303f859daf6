#include "research/fields/site_signs.h"

#include <bit>

#include "core/parallel.h"
#include "research/fields/drawn_sites.h"
#include "sites/closest_on_face.h"
#include "volume/field_writer.h"

namespace sdm::fields {
namespace {

constexpr std::size_t kPacket = sites::ClosestPacket::kSize;

// Decides the signs of the points of a row, a packet at a time.
class RowSigns {
 public:
  RowSigns(const DrawingTask& task, DistanceField& field)
      : task_(task), field_(field), box_(bounds(task.sites.mesh)) {}

  /// Points outside O2's box are outside O2.
  void decide(std::uint32_t j, std::uint32_t k, std::span<const std::uint32_t> winners) {
    const Grid& grid = task_.grid;
    for (std::uint32_t i = 0; i < grid.dims[0]; ++i) {
      const Vec3 q = grid.point(i, j, k);
      if (winners[i] == kNone || !sdm::contains(box_, q)) continue;
      const auto [type, site] = site_of(winners[i]);
      points_[packet_.count] = q;
      index_[packet_.count] = grid.index(i, j, k);
      packet_.set(packet_.count, q,
                  sites::closest_around_face(task_.sites, task_.sites.face_of(type, site), q));
      if (++packet_.count == kPacket) flush();
    }
    flush();
  }

 private:
  void flush() {
    if (packet_.count == 0) return;
    for (std::uint32_t inside = task_.is_inside(std::span(points_).first(packet_.count), packet_);
         inside != 0; inside &= inside - 1) {
      float& d = field_.distance[index_[std::countr_zero(inside)]];
      d = -d;
    }
    packet_.count = 0;
  }

  const DrawingTask& task_;
  DistanceField& field_;
  Box box_;
  sites::ClosestPacket packet_{};
  std::array<Vec3, kPacket> points_{};
  std::array<std::size_t, kPacket> index_{};
};

}  // namespace

void store_sites(const DrawingTask& task, std::span<const std::uint32_t> winners, DistanceField& field) {
  const Grid& grid = task.grid;
  const volume::FieldWriter writer(field);
  const std::size_t rows = std::size_t{grid.dims[1]} * grid.dims[2];
  parallel_for(rows, 32, task.options.progress, "sign", [&](std::size_t begin, std::size_t end) {
    RowSigns signs(task, field);
    for (std::size_t row = begin; row < end; ++row) {
      const std::span<const std::uint32_t> found = winners.subspan(row * grid.dims[0], grid.dims[0]);
      if (task.is_signed)
        signs.decide(static_cast<std::uint32_t>(row % grid.dims[1]),
                     static_cast<std::uint32_t>(row / grid.dims[1]), found);
      for (std::size_t i = 0; i < found.size(); ++i)
        if (found[i] != kNone) {
          const auto [type, site] = site_of(found[i]);
          writer.site(row * grid.dims[0] + i, type, site);
        }
    }
  });
}

}  // namespace sdm::fields
