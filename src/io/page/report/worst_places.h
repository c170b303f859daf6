// Where a surface or a cloud is farthest from the other mesh.
#pragma once

#include <sdm/map.h>
#include <sdm/surface.h>

#include <cstdint>
#include <span>
#include <vector>

namespace sdm::io {

struct Place {
  double distance = 0;
  Vec3 point{};
  std::uint64_t sample = kNone;  ///< the texel, kNone at a vertex of the mesh; or the number of the point
};

/// The place of the largest |distance| in each cell of a grid over a box. Cells are as wide as worst places
/// are apart, 6 % of the diagonal.
class LargestByCell {
 public:
  /// Places outside of the box belong to the cells at its border.
  explicit LargestByCell(const Box& box);
  /// Ignores what is not finite.
  void add(const Place& place);
  void add(const LargestByCell& other);
  /// The places of all cells that have one other than 0, the largest |distance| first.
  [[nodiscard]] std::vector<Place> largest() const;
  [[nodiscard]] double width() const { return width_; }

 private:
  static constexpr double kApart = 0.06;    // of the diagonal
  static constexpr std::size_t kSide = 18;  // cells along a side of the box, which is at most the diagonal
  static_assert(kSide * kApart > 1);

  [[nodiscard]] std::size_t cell(const Vec3& p) const;

  Vec3 lo_;
  double width_;
  std::vector<Place> places_;
};

/// The largest one of all, then the largest of other neighbourhoods, each at least as far from those before
/// it as cells are wide; at most ten.
[[nodiscard]] std::vector<Place> worst_places(const LargestByCell& cells);

/// The same of the texels and of the vertices of faces, in the box of the mesh. `vertex_distances`: one for
/// each vertex of the mesh, not finite where there is none. Cost: linear, all cores.
[[nodiscard]] std::vector<Place> worst_places(const Surface& surface, const DistanceMap& map,
                                              std::span<const float> vertex_distances);

}  // namespace sdm::io
