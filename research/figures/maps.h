// Two bodies that carry maps to each other, and the error of maps.
#pragma once

#include <sdm/sdm.h>

#include <array>
#include <memory>

#include "research/figures/view.h"

namespace sdm::figures {

/// A body as the surface that carries a map and as the sites that the other body's map measures to.
struct Side {
  Surface surface;
  Sites sites;
  DistanceMap map{};

  Side(const Mesh& mesh, std::uint32_t resolution) : surface(mesh, {.resolution = resolution}), sites(mesh) {}
  void refit(std::span<const Vec3> positions) {
    surface.refit(positions);
    sites.refit(positions);
  }
};

/// Two of them, and the maps in both directions.
struct Pair {
  std::array<Side, 2> sides;

  Pair(const std::array<Mesh, 2>& meshes, std::uint32_t resolution)
      : sides{Side(meshes[0], resolution), Side(meshes[1], resolution)} {}
  void refit(const std::array<std::vector<Vec3>, 2>& positions) {
    for (int b = 0; b < 2; ++b) sides[b].refit(positions[b]);
  }
  /// Unsigned maps, as the paper's; null: the cpu engine.
  void compute(const std::shared_ptr<const Engine>& engine = nullptr);
  [[nodiscard]] std::size_t texels() const {
    return sides[0].surface.sample_texels().size() + sides[1].surface.sample_texels().size();
  }
  [[nodiscard]] std::size_t triangles() const {
    return sides[0].surface.mesh().triangles.size() + sides[1].surface.mesh().triangles.size();
  }
  /// The diagonal of the bounding box of both bodies, to which errors are relative.
  [[nodiscard]] double diagonal() const;
  /// The largest error of |distance| at any texel of both present maps, compared with the reference engine,
  /// relative to diagonal(). Infinite where a value is missing. Cost: two maps by the reference engine.
  [[nodiscard]] double error_at_samples() const;
};

/// Pictures of both maps on the bodies: distance, Voronoi diagram and direction.
struct MapPictures {
  io::Picture distance, voronoi, direction, legend;
};
/// `inside`: the second body is a box around the first one.
[[nodiscard]] MapPictures paint(const Pair& pair, const View& view, bool inside = false);
/// The bodies themselves, each in a colour of its own.
[[nodiscard]] io::Picture paint_bodies(const Pair& pair, const View& view, bool inside = false);

}  // namespace sdm::figures
