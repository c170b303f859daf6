#include <sdm/error.h>
#include <sdm/execution.h>
#include <sdm/map_files.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <numbers>
#include <string>
#include <vector>

#include "core/memory.h"
#include "core/parallel.h"
#include "io/image/pictures/canvas.h"
#include "io/image/pictures/face_scales.h"
#include "io/image/pictures/legend.h"
#include "io/image/pictures/picture.h"
#include "io/image/views/render_view.h"
#include "io/image/views/view_layout.h"

namespace sdm {

using namespace io;

namespace {

constexpr double kScaleBarHeight = 46;  // below the cells
constexpr double kTitleText = 18, kViewText = 15;
constexpr double kRing = 9;         // the radius of marks
constexpr double kTextWidth = 196;  // the widest text of a mark
constexpr std::array kDashes{4.0, 3.0};

struct Mark {
  Vec3 point;
  std::string text;
};

std::vector<Mark> marks_of(const std::optional<Extremes>& extremes, const std::string& units) {
  std::vector<Mark> marks;
  if (!extremes) return marks;
  const auto add = [&](const char* name, const Extreme& extreme) {
    marks.push_back({extreme.point, std::string(name) + " " + value_label(extreme.distance) +
                                        (units.empty() ? "" : " " + units)});
  };
  add("min", extremes->min);
  add("max", extremes->max);
  return marks;
}

ViewScene scene_of(const Surface& surface, const DistanceMap& map, std::span<const float> vertex_distances,
                   const ColorScale& scale, const FaceScales& of_faces, const Mesh* other) {
  ViewScene scene{.surface = &surface,
                  .distances = std::span(map.distance).first(map.texels()),
                  .vertex_distances = vertex_distances,
                  .scale = scale,
                  .of_faces = &of_faces,
                  .other = other};
  run_concurrently({[&] { scene.normals = &shading_normals(surface); },
                    [&] {
                      if (other != nullptr) scene.other_normals = shading_normals(*other);
                    }});
  return scene;
}

// The axes of the mesh that lie in the picture, from the lower left corner of a cell.
void draw_axes(Canvas& canvas, const PlacedView& view) {
  constexpr double kLength = 26, kHead = 6;
  const Projection& p = view.projection;
  const double x = view.x + 50.0, y = view.y + p.height - 50.0;
  for (const bool halo : {true, false}) {
    canvas.set_color(halo ? kViewBackground : kLineColor);
    cairo_set_line_width(canvas.cairo(), halo ? 6 : 1.5);
    for (int k = 0; k < 3; ++k) {
      const double dx = p.right[k], dy = -p.up[k];
      if (dx == 0 && dy == 0) continue;
      const double to_x = x + kLength * dx, to_y = y + kLength * dy;
      canvas.line(x, y, to_x, to_y);
      cairo_move_to(canvas.cairo(), to_x + kHead * dx, to_y + kHead * dy);
      cairo_line_to(canvas.cairo(), to_x - 0.5 * kHead * dy, to_y + 0.5 * kHead * dx);
      cairo_line_to(canvas.cairo(), to_x + 0.5 * kHead * dy, to_y - 0.5 * kHead * dx);
      cairo_close_path(canvas.cairo());
      halo ? cairo_stroke(canvas.cairo()) : cairo_fill(canvas.cairo());
      const std::string letter(1, "xyz"[k]);
      const double letter_x = to_x + 14 * dx, letter_y = to_y + 14 * dy + 0.36 * kViewText;
      if (halo)  // also where the part is behind it
        for (const double sx : {-2.0, 0.0, 2.0})
          for (const double sy : {-2.0, 0.0, 2.0})
            canvas.text(letter_x + sx, letter_y + sy, letter, kViewText, 20, false, 0.5);
      else
        canvas.text(letter_x, letter_y, letter, kViewText, 20, false, 0.5);
      cairo_new_path(canvas.cairo());
    }
  }
}

// A ring around a place with its text beside it, inside the cell; dashed, with a line to the text, if O1
// hides the place. `texts`: the corners of those that the cell has.
void draw_mark(Canvas& canvas, const PlacedView& view, const Mark& mark, bool hidden,
               std::vector<Vec2>& texts) {
  cairo_t* cairo = canvas.cairo();
  const Projection& p = view.projection;
  const Vec3 at = p(mark.point);
  const double x = view.x + at[0], y = view.y + at[1];
  for (const bool halo : {true, false}) {
    canvas.set_color(halo ? Rgb{255, 255, 255} : kInk);
    cairo_set_line_width(cairo, halo ? 5 : 2);
    if (hidden && !halo) cairo_set_dash(cairo, kDashes.data(), static_cast<int>(kDashes.size()), 0);
    cairo_new_path(cairo);
    cairo_arc(cairo, x, y, kRing, 0, 2 * std::numbers::pi);
    cairo_stroke(cairo);
    cairo_set_dash(cairo, nullptr, 0, 0);
    if (hidden) continue;
    for (const double dx : {-1.0, 1.0}) canvas.line(x + dx * kRing, y, x + dx * (kRing + 5), y);
    for (const double dy : {-1.0, 1.0}) canvas.line(x, y + dy * kRing, x, y + dy * (kRing + 5));
  }

  constexpr double kHeight = 24, kAway = 18;
  const double width = hidden ? 196 : 132;
  const double left = view.x + 4, right = view.x + p.width - width - 4.0;
  const double top = view.y + 4 + kTitleText, bottom = view.y + p.height - kHeight - 4.0;
  Vec2 text{x + kAway, y - kHeight - 6};
  if (text[0] > right) text[0] = x - kAway - width;
  text = {std::clamp(text[0], left, std::max(left, right)), std::clamp(text[1], top, std::max(top, bottom))};
  for (const Vec2& other : texts)
    if (std::abs(other[0] - text[0]) < kTextWidth && std::abs(other[1] - text[1]) < kHeight)
      text[1] = other[1] + kHeight + 2 <= bottom ? other[1] + kHeight + 2 : other[1] - kHeight - 2;
  texts.push_back(text);
  if (hidden) {  // from the ring to the nearest point of the text
    const double to_x = std::clamp(x, text[0], text[0] + width);
    const double to_y = std::clamp(y, text[1], text[1] + kHeight);
    if (const double away = std::hypot(to_x - x, to_y - y); away > kRing) {
      cairo_set_line_width(cairo, 1.5);
      canvas.line(x + kRing * (to_x - x) / away, y + kRing * (to_y - y) / away, to_x, to_y);
      cairo_new_path(cairo);
    }
  }
  cairo_set_source_rgba(cairo, 1, 1, 1, 0.85);
  cairo_rectangle(cairo, text[0], text[1], width, kHeight);
  cairo_fill(cairo);
  canvas.set_color(kInk);
  canvas.text(text[0] + width / 2, text[1] + 17, mark.text + (hidden ? ", behind" : ""), kViewText, width - 8,
              false, 0.5);
}

// A word in its colour, as the pages have them, at the right end of the row of the scale bar.
void draw_verdict(Canvas& canvas, const ViewLayout& layout, Verdict verdict) {
  constexpr double kLong = 150, kTall = 32;
  const double x = layout.width - kLong - kViewGap, y = layout.height + 0.35 * kScaleBarHeight - kTall / 2;
  canvas.set_color(verdict == Verdict::pass   ? Rgb{0, 97, 61}
                   : verdict == Verdict::fail ? Rgb{163, 19, 14}
                                              : Rgb{122, 75, 0});
  cairo_rectangle(canvas.cairo(), x, y, kLong, kTall);
  cairo_fill(canvas.cairo());
  canvas.set_color({255, 255, 255});
  canvas.text(x + kLong / 2, y + kTall / 2 + 0.36 * kTitleText, name_of(verdict), kTitleText, kLong - 16,
              true, 0.5);
}

// The longest round length that takes at most a fifth of the row.
void draw_scale_bar(Canvas& canvas, const ViewLayout& layout, const std::string& units) {
  const double most = 0.2 * layout.width / layout.scale;
  const double decade = std::pow(10, std::floor(std::log10(most)));
  double length = decade;
  for (const double step : {2.0, 5.0})
    if (step * decade <= most) length = step * decade;
  const double x = 2 * kViewGap, end = x + layout.scale * length, y = layout.height + 0.35 * kScaleBarHeight;
  canvas.set_color(kInk);
  cairo_set_line_width(canvas.cairo(), 2);
  canvas.line(x, y, end, y);
  for (const double at : {x, end}) canvas.line(at, y - 6, at, y + 6);
  cairo_new_path(canvas.cairo());
  canvas.text(end + 14, y + 0.36 * kViewText,
              value_label(length) + (units.empty() ? "" : " " + units) + ", in all views", kViewText, 300);
}

}  // namespace

void write_views_png(const std::filesystem::path& file, const Surface& surface, const DistanceMap& map,
                     std::span<const float> vertex_distances, const Mesh* other,
                     const PictureOptions& options) try {
  const std::optional<Extremes> found = extremes(surface, map, vertex_distances);
  const ColorScale scale = color_scale(surface, map, options);
  const FaceScales of_faces(scale, options);
  const Box box = bounds(surface.mesh());
  const ViewLayout layout = layout_views(other != nullptr ? shown_box(box, bounds(*other)) : box, options.up);
  const std::vector<Mark> marks = marks_of(found, options.units);
  std::vector<Vec3> places;
  places.reserve(marks.size());
  for (const Mark& mark : marks) places.push_back(mark.point);

  const ViewScene scene = scene_of(surface, map, vertex_distances, scale, of_faces, other);
  std::array<View, 6> views;
  parallel_for(views.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      views[i] = render_view(scene, layout.views[i].projection, places);
  });

  // A place that no view shows is marked in the one where the least is in front of it.
  std::vector<std::size_t> shown_hidden(marks.size(), views.size());
  for (std::size_t k = 0; k < marks.size(); ++k)
    if (std::ranges::none_of(views, [&](const View& view) { return view.visible[k]; }))
      shown_hidden[k] = static_cast<std::size_t>(
          std::ranges::min_element(views, {}, [&](const View& view) { return view.in_front[k]; }) -
          views.begin());

  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  LegendText text = legend_text(map, found ? found->min.distance : kNan, found ? found->max.distance : kNan,
                                scale, options.units);
  if (other != nullptr) text.notes.emplace_back("pale: the other mesh");
  of_faces.describe(text);
  const Picture legend = draw_legend(of_faces.of_legend(), text, layout.height);
  Canvas canvas(layout.width + legend.width, std::max(layout.height + kScaleBarHeight, double(legend.height)),
                1);
  canvas.image(layout.width, 0, legend);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const PlacedView& view = layout.views[i];
    canvas.image(view.x, view.y, views[i].picture);
    canvas.set_color(kInk);
    canvas.text(view.x + 12, view.y + 25, view.name, kTitleText, view.projection.width - 24, true);
    draw_axes(canvas, view);
    std::vector<Vec2> texts;
    for (std::size_t k = 0; k < marks.size(); ++k)
      if (const bool hidden = !views[i].visible[k]; !hidden || shown_hidden[k] == i)
        draw_mark(canvas, view, marks[k], hidden, texts);
  }
  draw_scale_bar(canvas, layout, options.units);
  if (options.verdict) draw_verdict(canvas, layout, *options.verdict);
  write_picture(file, canvas.picture("the views"));
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

void write_view_png(const std::filesystem::path& file, const Surface& surface, const DistanceMap& map,
                    std::span<const float> vertex_distances, const ViewOptions& view,
                    const PictureOptions& options) try {
  constexpr std::uint32_t kLeastSize = 64, kMostSize = 8192;
  if (std::min(view.width, view.height) < kLeastSize || std::max(view.width, view.height) > kMostSize)
    throw Error("a view has from 64 to 8192 pixels a side");
  if (const double length = norm(view.towards); !(length > 0 && std::isfinite(length)))
    throw Error("the direction of a view must be finite and not zero");
  if (!view.other_distances.empty() &&
      (view.other == nullptr || view.other_distances.size() != view.other->positions.size()))
    throw Error("the distances that colour O2 are not one per vertex of it");
  const std::optional<Extremes> found = extremes(surface, map, vertex_distances);
  const ColorScale scale = color_scale(surface, map, options);
  const FaceScales of_faces(scale, options);
  std::vector<Box> boxes{bounds(surface.mesh())};
  if (view.other != nullptr) boxes.push_back(bounds(*view.other));
  ViewScene scene = scene_of(surface, map, vertex_distances, scale, of_faces, view.other);
  scene.other_distances = view.other_distances;
  const Projection projection = view_from(boxes, view.towards, options.up, view.width, view.height);
  const Picture picture = render_view(scene, projection, {}).picture;
  if (!view.legend) return write_picture(file, picture);

  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  LegendText text = legend_text(map, found ? found->min.distance : kNan, found ? found->max.distance : kNan,
                                scale, options.units);
  if (view.other != nullptr && view.other_distances.empty()) text.notes.emplace_back("pale: the other mesh");
  of_faces.describe(text);
  const Picture legend = draw_legend(of_faces.of_legend(), text, view.height);
  Canvas canvas(view.width + legend.width, std::max(view.height, legend.height), 1);
  canvas.image(0, 0, picture);
  canvas.image(view.width, 0, legend);
  write_picture(file, canvas.picture("the view"));
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

}  // namespace sdm
