#include "io/image/views/view_layout.h"

#include <algorithm>
#include <cmath>

#include "geometry/vec.h"

namespace sdm::io {
namespace {

constexpr double kRowWidth = 1536;  // of the three cells of a row, without gaps
constexpr double kMostHeight = 620, kLeastHeight = 260, kLeastWidth = 260;
constexpr double kMargin = 30;    // between a part and the border of its cell
constexpr double kBeside = 0.5;   // of O1's diagonal: how much of O2 is shown beside O1
constexpr double kLeast = 0.002;  // of the diagonal: the least extent, of plane meshes

// The axes of the mesh that are seen to the right, up and towards the viewer of the front. It is seen against
// the direction in which a right-handed frame has its third axis.
std::array<Vec3, 3> front_frame(UpAxis axis) {
  const Vec3 right{1, 0, 0}, up = axis == UpAxis::z ? Vec3{0, 0, 1} : Vec3{0, 1, 0};
  return {right, up, cross(right, up)};
}

// The extent of a box along an axis of the mesh, to either side.
double extent(const Vec3& size, const Vec3& axis) {
  return std::abs(axis[0]) * size[0] + std::abs(axis[1]) * size[1] + std::abs(axis[2]) * size[2];
}

}  // namespace

ViewLayout layout_views(const Box& box, UpAxis up_axis) {
  const double diagonal = std::max(core::diagonal(box), 1e-300);
  Vec3 size = box.upper - box.lower;
  for (double& length : size) length = std::max(length, kLeast * diagonal);
  const auto [right, up, front] = front_frame(up_axis);

  ViewLayout layout;
  const std::array<std::array<Vec3, 3>, 6> frames{{{right, up, front},
                                                   {front, up, -right},
                                                   {right, -front, up},
                                                   {-right, up, -front},
                                                   {-front, up, right},
                                                   {right, front, -up}}};
  constexpr std::array<const char*, 6> kNames{"Front", "Left", "Top", "Back", "Right", "Bottom"};
  std::array<double, 3> widths{};
  double row = 0, tallest = 0;
  for (int k = 0; k < 3; ++k) {
    widths[k] = extent(size, frames[k][0]);
    row += widths[k];
    tallest = std::max(tallest, extent(size, frames[k][1]));
  }
  layout.scale =
      std::min((kRowWidth - 6 * kMargin) / row, (kMostHeight - kViewTitle - 2 * kMargin) / tallest);
  const auto height = static_cast<std::uint32_t>(
      std::max(kLeastHeight, std::ceil(layout.scale * tallest) + kViewTitle + 2 * kMargin));
  // What a row has left belongs to all of its cells.
  double used = 0;
  std::array<double, 3> cells{};
  for (int k = 0; k < 3; ++k)
    used += cells[k] = std::max(kLeastWidth, layout.scale * widths[k] + 2 * kMargin);
  const double more = std::max(0.0, kRowWidth - used) / 3;

  std::uint32_t x = kViewGap;
  for (int k = 0; k < 3; ++k) {
    const auto width = static_cast<std::uint32_t>(cells[k] + more);
    for (int below = 0; below < 2; ++below) {
      const int view = k + 3 * below;
      const auto& [r, u, t] = frames[view];
      // The title takes a strip of the cell, below which the part is centred.
      const Vec3 middle = centre(box) + (0.5 * kViewTitle / layout.scale) * u;
      layout.views[view] = {kNames[view],
                            {r, u, t, middle, layout.scale, width, height},
                            x,
                            kViewGap + below * (height + kViewGap)};
    }
    x += width + kViewGap;
  }
  layout.width = x;
  layout.height = 2 * height + 3 * kViewGap;
  return layout;
}

Projection view_from(std::span<const Box> boxes, const Vec3& towards, UpAxis up_axis, std::uint32_t width,
                     std::uint32_t height) {
  const auto [right, up, front] = front_frame(up_axis);
  Projection view{.width = width, .height = height};
  view.towards = normalized(towards[0] * right + towards[1] * up + towards[2] * front);
  // Seen from straight above or below, the front is at the bottom or the top, as in the views of both.
  const bool vertical = std::hypot(towards[0], towards[2]) < 1e-6 * std::abs(towards[1]);
  view.right = vertical ? right : normalized(cross(up, view.towards));
  view.up = cross(view.towards, view.right);
  std::array<double, 3> least{kInfinity, kInfinity, kInfinity}, most{-kInfinity, -kInfinity, -kInfinity};
  for (const Box& box : boxes)
    for (int corner = 0; corner < 8; ++corner) {
      Vec3 p;
      for (int k = 0; k < 3; ++k) p[k] = (corner >> k & 1) != 0 ? box.upper[k] : box.lower[k];
      const Vec3 seen{dot(p, view.right), dot(p, view.up), dot(p, view.towards)};
      for (int k = 0; k < 3; ++k) {
        least[k] = std::min(least[k], seen[k]);
        most[k] = std::max(most[k], seen[k]);
      }
    }
  const double wide = std::max(most[0] - least[0], 1e-300), tall = std::max(most[1] - least[1], 1e-300);
  view.scale = std::min((width - 2 * kMargin) / wide, (height - 2 * kMargin) / tall);
  view.centre = 0.5 * (least[0] + most[0]) * view.right + 0.5 * (least[1] + most[1]) * view.up +
                0.5 * (least[2] + most[2]) * view.towards;
  return view;
}

Box shown_box(const Box& part, const Box& other) {
  const double beside = kBeside * diagonal(part);
  Box shown = part;
  for (int k = 0; k < 3; ++k) {
    shown.lower[k] = std::min(part.lower[k], std::max(part.lower[k] - beside, other.lower[k]));
    shown.upper[k] = std::max(part.upper[k], std::min(part.upper[k] + beside, other.upper[k]));
  }
  return shown;
}

}  // namespace sdm::io
