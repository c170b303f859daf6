#include "io/image/views/render_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "io/image/pictures/canvas.h"
#include "surface/surface_data.h"

namespace sdm::io {
namespace {

constexpr double kVeil = 0.3;        // how much of O2 is seen in front of O1
constexpr double kOutline = 0.55;    // how dark outlines are
constexpr double kStep = 5;          // pixels of depth between neighbours that make an outline
constexpr double kVeilFrom = 8;      // pixels of depth by which O2 has to be in front
constexpr int kContrast = 12;        // of 255, between neighbours whose samples are averaged
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
int contrast(Rgb a, Rgb b) {
  return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
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

enum class Shading : std::uint8_t {
  none,
  centre,   // of the pixel
  differs,  // that of the centre differs from a neighbour's
  mixed,    // samples show different bodies
};

/// The pixels of a picture.
struct Pixels {
  Pixels(std::uint32_t width, std::uint32_t height)
      : picture{width, height, std::vector(std::size_t{width} * height, kViewBackground)},
        shading(picture.pixels.size(), Shading::none),
        depths(picture.pixels.size(), -std::numeric_limits<float>::infinity()) {}

  /// Finds the pixels of centres that differ from a neighbour's.
  void find_contrasts() {
    const std::size_t width = picture.width;
    for (const std::uint32_t pixel : drawn) {
      if (!has_centre(pixel)) continue;
      const bool is_last = (pixel + 1) % width == 0;
      for (const std::size_t other : {is_last ? pixel : pixel + std::size_t{1}, pixel + width})
        if (other < shading.size() && has_centre(other) &&
            contrast(picture.pixels[pixel], picture.pixels[other]) > kContrast)
          shading[pixel] = shading[other] = Shading::differs;
    }
  }
  [[nodiscard]] bool has_centre(std::size_t pixel) const {
    return shading[pixel] == Shading::centre || shading[pixel] == Shading::differs;
  }

  Picture picture;
  std::vector<Shading> shading;
  std::vector<float> depths;         ///< −∞ where no body is seen
  std::vector<std::uint32_t> drawn;  ///< pixels that show a body
};

class Renderer {
 public:
  Renderer(const ViewScene& scene, const Projection& projection)
      : scene_(scene),
        projection_(projection),
        light_(projection),
        colors_(scene),
        mesh_(scene.surface->mesh()),
        part_(mesh_, projection),
        is_ghost_solid_(scene.other != nullptr && !scene.other_distances.empty()),
        veil_(is_ghost_solid_ ? 0 : kVeilFrom / projection.scale) {
    if (scene.other != nullptr) ghost_.emplace(*scene.other, projection);
  }

  /// A pixel whose samples all show the same bodies has the colour of its centre, unless that differs from a
  /// neighbour's; all samples of the others are averaged.
  [[nodiscard]] Picture picture() const {
    Pixels pixels(projection_.width, projection_.height);
    constexpr std::uint32_t kTile = DepthBuffer::kTile;
    for (std::uint32_t row = 0; row < part_.height(); row += kTile)
      for (std::uint32_t column = 0; column < part_.width(); column += kTile) shade_tile(column, row, pixels);
    pixels.find_contrasts();
    for (const std::uint32_t pixel : pixels.drawn) {
      const std::uint32_t x = pixel % projection_.width, y = pixel / projection_.width;
      Rgb& shown = pixels.picture.pixels[pixel];
      if (pixels.shading[pixel] != Shading::centre) shown = average(x, y);
      if (is_outline(x, y, pixels.depths)) shown = rgb(mix(color(shown), color(kInk), kOutline));
    }
    return std::move(pixels.picture);
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
    [[nodiscard]] bool has_bodies_of(const Sample& o) const {
      return (face == kNone) == (o.face == kNone) && (other_face == kNone) == (o.other_face == kNone);
    }
  };
  static constexpr Sample kBackgroundSample{kNone, kNone};

  [[nodiscard]] Sample sample(const DepthBuffer::Seen& part, const DepthBuffer::Seen& other) const {
    return {part.face, part.face == kNone || other.depth > part.depth + veil_ ? other.face : kNone};
  }
  [[nodiscard]] Sample sample(std::uint32_t column, std::uint32_t row) const {
    const DepthBuffer::Seen& part = part_.seen(column, row);
    return ghost_ ? sample(part, ghost_->seen(column, row)) : Sample{part.face, kNone};
  }

  /// Colours pixels of the tile that begins at a sample by their centres.
  void shade_tile(std::uint32_t column, std::uint32_t row, Pixels& pixels) const {
    constexpr std::uint32_t kTile = DepthBuffer::kTile;
    const DepthBuffer::Tile& part = part_.tile(column, row);
    const DepthBuffer::Tile* other = ghost_ ? &ghost_->tile(column, row) : nullptr;
    if (part_.is_empty(part) && (other == nullptr || ghost_->is_empty(*other))) return;
    const auto shown = [&](std::size_t i) {
      return other != nullptr ? sample(part[i], (*other)[i]) : Sample{part[i].face, kNone};
    };
    const std::uint32_t left = column / kSamples,
                        right = std::min(projection_.width, left + kTile / kSamples);
    const std::uint32_t top = row / kSamples, bottom = std::min(projection_.height, top + kTile / kSamples);
    for (std::uint32_t y = top; y < bottom; ++y)
      for (std::uint32_t x = left; x < right; ++x) {
        const std::size_t i = std::size_t{kTile} * kSamples * (y - top) + kSamples * (x - left);
        const Sample first = shown(i);
        bool all = true;
        for (std::size_t k = 1; k < kSamples * kSamples; ++k)
          all = all && first.has_bodies_of(shown(i + k / kSamples * kTile + k % kSamples));
        if (all && first == kBackgroundSample) continue;
        const auto pixel = y * projection_.width + x;
        pixels.drawn.push_back(pixel);
        pixels.depths[pixel] = is_ghost_solid_ ? std::max(part[i].depth, (*other)[i].depth) : part[i].depth;
        pixels.shading[pixel] = all ? Shading::centre : Shading::mixed;
        if (all)
          pixels.picture.pixels[pixel] =
              rgb(sample_color({kSamples * (x + 0.5), kSamples * (y + 0.5)}, first));
      }
  }

  [[nodiscard]] Rgb average(std::uint32_t x, std::uint32_t y) const {
    Color sum{};
    for (std::uint32_t row = kSamples * y; row < kSamples * (y + 1); ++row)
      for (std::uint32_t column = kSamples * x; column < kSamples * (x + 1); ++column)
        sum = sum + sample_color({column + 0.5, row + 0.5}, sample(column, row));
    return rgb((1.0 / (kSamples * kSamples)) * sum);
  }

  [[nodiscard]] Color sample_color(const Vec2& at, const Sample& seen) const {
    if (seen.other_face != kNone && is_ghost_solid_) return other_color(at, seen.other_face);
    if (seen.face == kNone)
      return seen.other_face == kNone ? color(kViewBackground)
                                      : mix(color(kViewBackground), other_color(at, seen.other_face), 0.75);
    const auto [weights, is_back] = part_.point(at, mesh_.triangles[seen.face]);
    const Color part =
        light_(*scene_.normals, seen.face, weights, is_back) * color(colors_(seen.face, weights));
    return seen.other_face == kNone ? part : mix(part, other_color(at, seen.other_face), kVeil);
  }

  [[nodiscard]] Color other_color(const Vec2& at, std::uint32_t face) const {
    const Triangle& t = scene_.other->triangles[face];
    const auto [weights, is_back] = ghost_->point(at, t);
    const double light = light_(scene_.other_normals, face, weights, is_back);
    // Pale on every side, so that it is never darker than the part.
    if (scene_.other_distances.empty()) return (0.7 + 0.3 * light) * color(kGhost);
    double distance = 0;
    for (int k = 0; k < 3; ++k) distance += weights[k] * scene_.other_distances[t[k]];
    return light * color(scene_.scale(distance));
  }

  /// Whether a body ends at a pixel, or steps back behind it: O1, or O2 if it has distances.
  [[nodiscard]] bool is_outline(std::uint32_t x, std::uint32_t y, const std::vector<float>& depths) const {
    if (x == 0 || y == 0 || x + 1 == projection_.width || y + 1 == projection_.height) return false;
    const std::size_t width = projection_.width, at = y * width + x;
    const auto depth = [&](std::size_t pixel) { return projection_.scale * depths[pixel]; };
    const double here = depth(at);
    if (!std::isfinite(here)) return false;
    // Beyond what the slope of the surface explains: a rough plane seen at a small angle has no outlines. A
    // step of s between neighbours is 2 here − before − after = s, of a slope of s/2.
    const auto steps = [&](double before, double after) {
      if (!std::isfinite(before) || !std::isfinite(after)) return true;
      return 2 * here - before - after > kStep + 0.6 * std::abs(after - before);
    };
    return steps(depth(at - 1), depth(at + 1)) || steps(depth(at - width), depth(at + width));
  }

  const ViewScene& scene_;
  const Projection& projection_;
  Light light_;
  SurfaceColors colors_;
  const Mesh& mesh_;  // O1
  DepthBuffer part_;
  std::optional<DepthBuffer> ghost_;
  bool is_ghost_solid_;  // O2 has distances
  double veil_;          // by how much O2 has to be in front of O1 to be seen
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
