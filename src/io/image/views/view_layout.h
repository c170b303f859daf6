// How six views of a part are placed in a picture, at one scale.
#pragma once

#include <sdm/map_files.h>

#include <array>
#include <cstdint>
#include <span>

#include "io/image/views/depth_buffer.h"

namespace sdm::io {

struct PlacedView {
  const char* name = "";
  Projection projection;       ///< its width and height are those of the cell
  std::uint32_t x = 0, y = 0;  ///< the upper left corner of the cell
};

struct ViewLayout {
  std::array<PlacedView, 6> views;
  std::uint32_t width = 0, height = 0;  ///< of all cells, with the gaps around them
  double scale = 1;                     ///< pixels per unit of the mesh
};

inline constexpr std::uint32_t kViewGap = 12;    ///< around cells
inline constexpr std::uint32_t kViewTitle = 34;  ///< above the part in each cell

/// Opposite views above each other: front and back, left and right, top and bottom. `box`: what they show.
[[nodiscard]] ViewLayout layout_views(const Box& box, UpAxis up);

/// A view of all of the boxes' corners from a direction, given by its parts to the right, up and to the
/// front.
[[nodiscard]] Projection view_from(std::span<const Box> boxes, const Vec3& towards, UpAxis up,
                                   std::uint32_t width, std::uint32_t height);

/// The box of O1, with what there is of O2 beside it at a distance of up to half of O1's size.
[[nodiscard]] Box shown_box(const Box& part, const Box& other);

}  // namespace sdm::io
