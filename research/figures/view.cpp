#include "research/figures/view.h"

#include <sdm/rays.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "atlas/gutter.h"
#include "core/parallel.h"
#include "geometry/vec.h"

namespace sdm::figures {
namespace {

using io::Rgb;

constexpr std::uint32_t kSubsamples = 2;
constexpr Rgb kPaper{255, 255, 255};

/// All faces in view in one mesh.
struct Merged {
  Mesh mesh;
  struct Origin {
    std::uint32_t object, face;
  };
  std::vector<Origin> origins;  ///< of each face
};

Vec3 face_normal(const Mesh& mesh, const Triangle& face) {
  const Vec3& a = mesh.positions[face[0]];
  return normalized(cross(mesh.positions[face[1]] - a, mesh.positions[face[2]] - a));
}

Merged merge(const View& view, std::span<const Shown> objects) {
  Merged all;
  for (std::uint32_t object = 0; object < objects.size(); ++object) {
    const Mesh& mesh = objects[object].surface->mesh();
    const auto first = static_cast<std::uint32_t>(all.mesh.positions.size());
    all.mesh.positions.insert(all.mesh.positions.end(), mesh.positions.begin(), mesh.positions.end());
    for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
      const Triangle& t = mesh.triangles[f];
      if (objects[object].only_inside && dot(face_normal(mesh, t), view.eye - mesh.positions[t[0]]) > 0)
        continue;
      all.mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
      all.origins.push_back({object, f});
    }
  }
  return all;
}

/// The rays through the samples of the picture, by rows from the top.
std::vector<Ray> rays_of(const View& view) {
  const Vec3 forward = normalized(view.target - view.eye);
  const Vec3 right = normalized(cross(forward, view.up)), up = cross(right, forward);
  const double pixel = 2 * std::tan(view.field_of_view * std::numbers::pi / 360) / view.height;
  const std::uint32_t columns = view.width * kSubsamples, rows = view.height * kSubsamples;
  std::vector<Ray> rays;
  rays.reserve(std::size_t{columns} * rows);
  for (std::uint32_t row = 0; row < rows; ++row)
    for (std::uint32_t column = 0; column < columns; ++column) {
      const double x = (column + 0.5) / kSubsamples - 0.5 * view.width;
      const double y = 0.5 * view.height - (row + 0.5) / kSubsamples;
      rays.push_back({view.eye, normalized(forward + pixel * (x * right + y * up))});
    }
  return rays;
}

std::uint32_t texel_at(const Surface& surface, const atlas::Gutter& gutter, std::uint32_t face,
                       const Vec3& point) {
  const Vec2 uv = surface.to_atlas(face, point);
  const auto clamped = [](double x, std::uint32_t count) {
    return static_cast<std::uint32_t>(std::clamp(x, 0.0, count - 1.0));
  };
  return gutter.source(clamped(uv[0], surface.resolution()), clamped(uv[1], surface.rows()));
}

}  // namespace

Scenery::Scenery(const View& view, std::span<const Shown> objects)
    : width_(view.width), height_(view.height) {
  const Merged all = merge(view, objects);
  std::vector<atlas::Gutter> gutters;
  for (const Shown& each : objects)
    gutters.emplace_back(each.surface->resolution(), each.surface->texel_faces());
  const std::vector<Ray> rays = rays_of(view);
  const std::vector<RayHit> hits = first_hits(Sites(all.mesh), rays);
  seen_.resize(rays.size());
  parallel_for(rays.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (hits[i].face == kNone) continue;
      const auto [object, face] = all.origins[hits[i].face];
      const Surface& surface = *objects[object].surface;
      const Vec3 normal = face_normal(surface.mesh(), surface.mesh().triangles[face]);
      seen_[i] = {object, kNone, static_cast<float>(std::abs(dot(normal, rays[i].direction)))};
      if (surface.face_charts()[face] != kNone)
        seen_[i].texel =
            texel_at(surface, gutters[object], face, rays[i].origin + hits[i].t * rays[i].direction);
    }
  });
}

io::Picture Scenery::paint(const std::function<Rgb(const Seen&)>& color) const {
  io::Picture picture{width_, height_, std::vector<Rgb>(std::size_t{width_} * height_)};
  parallel_for(height_, 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y)
      for (std::size_t x = 0; x < width_; ++x) {
        std::array<float, 3> sum{};
        for (std::uint32_t k = 0; k < kSubsamples * kSubsamples; ++k) {
          const std::size_t row = y * kSubsamples + k / kSubsamples,
                            column = x * kSubsamples + k % kSubsamples;
          const Seen& s = seen_[row * width_ * kSubsamples + column];
          const Rgb c = s.object == kNone ? kPaper : s.texel == kNone ? io::kNoValue : color(s);
          const float light = s.object == kNone ? 1 : 0.6f + 0.4f * s.light;
          sum[0] += light * c.r;
          sum[1] += light * c.g;
          sum[2] += light * c.b;
        }
        const auto mean = [](float total) {
          return static_cast<std::uint8_t>(std::floor(total / (kSubsamples * kSubsamples) + 0.5f));
        };
        picture.pixels[y * width_ + x] = {mean(sum[0]), mean(sum[1]), mean(sum[2])};
      }
  });
  return picture;
}

View view_of(const Box& bounds, const Vec3& from, std::uint32_t width, std::uint32_t height) {
  View view{.target = centre(bounds), .field_of_view = 24, .width = width, .height = height};
  const Vec3 toward = normalized(from);
  const Vec3 right = normalized(cross(-toward, view.up)), up = cross(right, -toward);
  const double tangent = std::tan(view.field_of_view * std::numbers::pi / 360);
  const double tangent_across = tangent * width / height;
  double away = 0;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 p;
    for (int k = 0; k < 3; ++k) p[k] = (corner >> k & 1) != 0 ? bounds.upper[k] : bounds.lower[k];
    const Vec3 d = p - view.target;
    away = std::max({away, dot(d, toward) + std::abs(dot(d, up)) / tangent,
                     dot(d, toward) + std::abs(dot(d, right)) / tangent_across});
  }
  view.eye = view.target + 1.04 * away * toward;
  return view;
}

}  // namespace sdm::figures
