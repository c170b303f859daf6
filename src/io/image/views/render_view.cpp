#include "io/image/views/render_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "io/image/pictures/canvas.h"
#include "surface/surface_data.h"

namespace sdm::io {
namespace {

constexpr double kVeil = 0.3;        // how much of O2 is seen in front of O1
constexpr double kOutline = 0.55;    // how dark outlines are
constexpr double kStep = 5;          // pixels of depth between neighbours that make an outline
constexpr double kVeilFrom = 8;      // pixels of depth by which O2 has to be in front
constexpr double kHiddenBelow = 12;  // pixels of depth by which a place has to be behind O1's surface

using Color = Vec3;  // red, green and blue, from 0 to 255

Color mix(const Color& a, const Color& b, double part) {
  return (1 - part) * a + part * b;
}
Color color(Rgb c) {
  return {double(c.r), double(c.g), double(c.b)};
}
Rgb rgb(const Color& c) {
  const auto byte = [](double x) { return static_cast<std::uint8_t>(std::clamp(x + 0.5, 0.0, 255.0)); };
  return {byte(c[0]), byte(c[1]), byte(c[2])};
}

/// The brightness of a face, from 0 to 1: lit from the viewer's upper left, the inside of an open body
/// darker.
class Light {
 public:
  explicit Light(const Projection& p) : from_(normalized(-0.35 * p.right + 0.5 * p.up + 0.8 * p.towards)) {}

  /// `back`: of the face the viewer sees the back.
  [[nodiscard]] double operator()(const ShadingNormals& normals, std::uint32_t face, const Vec3& weights,
                                  bool back) const {
    Vec3 normal{};
    for (int k = 0; k < 3; ++k) {
      const Vec3f& n = normals.normals[normals.corner[face][k]];
      normal += weights[k] * Vec3{n[0], n[1], n[2]};
    }
    const double lit = std::max(0.0, (back ? -1 : 1) * dot(normalized(normal), from_));
    return (back ? 0.5 : 0.62) + 0.38 * lit;
  }

 private:
  Vec3 from_;
};

/// The colours of O1.
class SurfaceColors {
 public:
  explicit SurfaceColors(const ViewScene& scene)
      : scene_(scene),
        data_(internals(*scene.surface)),
        columns_(static_cast<int>(data_.resolution)),
        rows_(static_cast<int>(data_.rows)) {}

  /// The colour of a point of a face: that of the texel there or, at the border of a chart, of a neighbouring
  /// texel of the same chart.
  [[nodiscard]] Rgb operator()(std::uint32_t face, const Vec3& weights) const {
    if (const std::uint32_t chart = data_.face_charts[face]; chart != kNone) {
      const std::array<Vec2, 3>& corners = data_.corners[face];
      Vec2 place{};
      for (int k = 0; k < 3; ++k) place = place + weights[k] * corners[k];
      const int x = static_cast<int>(place[0]), y = static_cast<int>(place[1]);
      if (x >= 0 && x < columns_ && y >= 0 && y < rows_ && is_of_chart(texel_at(x, y), chart))
        return color_of_texel(texel_at(x, y));
      double nearest = kInfinity;
      std::optional<std::size_t> found;
      for (int row = std::max(0, y - 1); row <= std::min(rows_ - 1, y + 1); ++row)
        for (int column = std::max(0, x - 1); column <= std::min(columns_ - 1, x + 1); ++column) {
          const std::size_t texel = texel_at(column, row);
          if (!is_of_chart(texel, chart)) continue;
          const double away = std::max(std::abs(column + 0.5 - place[0]), std::abs(row + 0.5 - place[1]));
          if (away < nearest) {
            nearest = away;
            found = texel;
          }
        }
      if (found) return color_of_texel(*found);
    }
    double distance = 0;
    for (int k = 0; k < 3; ++k)
      distance += weights[k] * scene_.vertex_distances[data_.mesh.triangles[face][k]];
    return (*scene_.of_faces)(face, distance);
  }

 private:
  [[nodiscard]] std::size_t texel_at(int column, int row) const {
    return static_cast<std::size_t>(row) * data_.resolution + static_cast<std::size_t>(column);
  }
  [[nodiscard]] bool is_of_chart(std::size_t texel, std::uint32_t chart) const {
    const std::uint32_t owner = data_.map_faces[texel];
    return owner != kNone && data_.face_charts[owner] == chart;
  }
  [[nodiscard]] Rgb color_of_texel(std::size_t texel) const {
    return (*scene_.of_faces)(data_.map_faces[texel], scene_.distances[texel]);
  }

  const ViewScene& scene_;
  const surface::SurfaceData& data_;
  int columns_, rows_;
};

class Renderer {
 public:
  Renderer(const ViewScene& scene, const Projection& projection)
      : scene_(scene),
        projection_(projection),
        light_(projection),
        colors_(scene),
        mesh_(scene.surface->mesh()),
        part_(mesh_, projection) {
    if (scene.other != nullptr) ghost_.emplace(*scene.other, projection);
  }

  [[nodiscard]] Picture picture() const {
    Picture picture{projection_.width, projection_.height, {}};
    picture.pixels.resize(std::size_t{picture.width} * picture.height, kViewBackground);
    constexpr std::uint32_t kPixels = DepthBuffer::kTile / kSamples;  // of a tile
    for (std::uint32_t top = 0; top < picture.height; top += kPixels)
      for (std::uint32_t left = 0; left < picture.width; left += kPixels) {
        if (part_.is_empty_tile(kSamples * left, kSamples * top) &&
            (!ghost_ || ghost_->is_empty_tile(kSamples * left, kSamples * top)))
          continue;
        for (std::uint32_t y = top; y < std::min(picture.height, top + kPixels); ++y)
          for (std::uint32_t x = left; x < std::min(picture.width, left + kPixels); ++x)
            picture.pixels[std::size_t{y} * picture.width + x] = pixel(x, y);
      }
    return picture;
  }

  /// How far O1 is in front of a place; negative if it is not.
  [[nodiscard]] double in_front_of(const Vec3& place) const {
    const Vec3 at = projection_(place);
    if (!(at[0] >= 0 && at[0] < projection_.width && at[1] >= 0 && at[1] < projection_.height))
      return kInfinity;
    const auto x = static_cast<std::uint32_t>(at[0]), y = static_cast<std::uint32_t>(at[1]);
    return part_.seen(kSamples * x, kSamples * y).depth - at[2];
  }
  [[nodiscard]] bool hides(double in_front) const { return !(in_front < kHiddenBelow / projection_.scale); }

 private:
  static constexpr std::uint32_t kSamples = DepthBuffer::kSamples;

  /// What a sample shows.
  struct Sample {
    std::uint32_t face;        ///< of O1; kNone if there is none
    std::uint32_t other_face;  ///< of O2, in front of O1 or beside it; kNone if there is none

    friend bool operator==(const Sample&, const Sample&) = default;
  };
  static constexpr Sample kBackgroundSample{kNone, kNone};

  [[nodiscard]] Sample sample(std::uint32_t column, std::uint32_t row) const {
    const DepthBuffer::Seen& part = part_.seen(column, row);
    if (!ghost_) return {part.face, kNone};
    const DepthBuffer::Seen& other = ghost_->seen(column, row);
    const double away = scene_.other_distances.empty() ? kVeilFrom / projection_.scale : 0;
    const bool is_seen = part.face == kNone || other.depth > part.depth + away;
    return {part.face, is_seen ? other.face : kNone};
  }

  [[nodiscard]] Rgb pixel(std::uint32_t x, std::uint32_t y) const {
    struct Shaded {
      Sample sample;
      Color color;
    };
    std::array<Shaded, std::size_t{kSamples} * kSamples> shaded;
    std::size_t count = 0;
    Color sum{};
    for (std::uint32_t row = kSamples * y; row < kSamples * (y + 1); ++row)
      for (std::uint32_t column = kSamples * x; column < kSamples * (x + 1); ++column) {
        const Sample seen = sample(column, row);
        // Samples of a pixel in the same face have almost the same colour.
        std::size_t i = 0;
        while (i < count && shaded[i].sample != seen) ++i;
        if (i == count) shaded[count++] = {seen, sample_color(column, row, seen)};
        sum = sum + shaded[i].color;
      }
    if (count == 1 && shaded[0].sample == kBackgroundSample) return kViewBackground;
    sum = (1.0 / (kSamples * kSamples)) * sum;
    return rgb(is_outline(x, y) ? mix(sum, color(kInk), kOutline) : sum);
  }

  [[nodiscard]] Color sample_color(std::uint32_t column, std::uint32_t row, const Sample& seen) const {
    const bool is_solid = !scene_.other_distances.empty();  // O2
    if (seen.other_face != kNone && is_solid) return other_color(column, row, seen.other_face);
    if (seen.face == kNone)
      return seen.other_face == kNone
                 ? color(kViewBackground)
                 : mix(color(kViewBackground), other_color(column, row, seen.other_face), 0.75);
    const auto [weights, is_back] = part_.point(column, row, mesh_.triangles[seen.face]);
    const Color part =
        light_(*scene_.normals, seen.face, weights, is_back) * color(colors_(seen.face, weights));
    return seen.other_face == kNone ? part : mix(part, other_color(column, row, seen.other_face), kVeil);
  }

  [[nodiscard]] Color other_color(std::uint32_t column, std::uint32_t row, std::uint32_t face) const {
    const Triangle& t = scene_.other->triangles[face];
    const auto [weights, is_back] = ghost_->point(column, row, t);
    const double light = light_(scene_.other_normals, face, weights, is_back);
    // Pale on every side, so that it is never darker than the part.
    if (scene_.other_distances.empty()) return (0.7 + 0.3 * light) * color(kGhost);
    double distance = 0;
    for (int k = 0; k < 3; ++k) distance += weights[k] * scene_.other_distances[t[k]];
    return light * color(scene_.scale(distance));
  }

  /// Whether a body ends at a pixel, or steps back behind it: O1, or O2 if it has distances.
  [[nodiscard]] bool is_outline(std::uint32_t x, std::uint32_t y) const {
    const bool both = ghost_ && !scene_.other_distances.empty();
    const auto depth = [&](std::uint32_t column, std::uint32_t row) {
      const float part = part_.seen(kSamples * column, kSamples * row).depth;
      return projection_.scale *
             (both ? std::max(part, ghost_->seen(kSamples * column, kSamples * row).depth) : part);
    };
    const double here = depth(x, y);
    if (!std::isfinite(here)) return false;
    // Beyond what the slope of the surface explains: a rough plane seen at a small angle has no outlines. A
    // step of s between neighbours is 2 here − before − after = s, of a slope of s/2.
    const auto steps = [&](double before, double after) {
      if (!std::isfinite(before) || !std::isfinite(after)) return true;
      return 2 * here - before - after > kStep + 0.6 * std::abs(after - before);
    };
    const bool inner = x > 0 && y > 0 && x + 1 < projection_.width && y + 1 < projection_.height;
    return inner && (steps(depth(x - 1, y), depth(x + 1, y)) || steps(depth(x, y - 1), depth(x, y + 1)));
  }

  const ViewScene& scene_;
  const Projection& projection_;
  Light light_;
  SurfaceColors colors_;
  const Mesh& mesh_;  // O1
  DepthBuffer part_;
  std::optional<DepthBuffer> ghost_;
};

}  // namespace

View render_view(const ViewScene& scene, const Projection& projection, std::span<const Vec3> places) {
  const Renderer renderer(scene, projection);
  View view{.picture = renderer.picture(), .visible = {}, .in_front = {}};
  for (const Vec3& place : places) {
    view.in_front.push_back(renderer.in_front_of(place));
    view.visible.push_back(!renderer.hides(view.in_front.back()));
  }
  return view;
}

}  // namespace sdm::io
