// The surface A: lengths that its measures depend on, areas and normals of its faces, and random points of
// it.
#pragma once

#include <sdm/mesh.h>

#include <cstdint>
#include <vector>

#include "geometry/triangle.h"

namespace sdm::metrics {

/// Lengths of both meshes together.
struct Scale {
  double size = 0;      ///< the diagonal of their box
  double rounding = 0;  ///< of distances and coordinates, in double precision
  double accuracy = 0;  ///< of the cpu engine
};

struct FaceArea {
  double area = 0;
  double error = 0;  ///< of rounding, at most: that of a needle may be more than its area
};

[[nodiscard]] inline FaceArea area_of(const Corners& face) {
  constexpr double kAreaRounding = 1e-15;
  const auto& [p, q, r] = face;
  return {norm(cross(q - p, r - p)) / 2, kAreaRounding * norm(q - p) * norm(r - p)};
}

/// Zero of a face without area.
[[nodiscard]] inline Vec3 unit_normal(const Mesh& mesh, std::uint32_t face) {
  const auto [a, b, c] = corners_of(mesh, face);
  const Vec3 normal = cross(b - a, c - a);
  const double length = norm(normal);
  return length > 0 ? (1 / length) * normal : Vec3{};
}

/// Independent random numbers in [0, 1), each by its index: S. Vigna's splitmix64.
class RandomNumbers {
 public:
  RandomNumbers(std::uint64_t seed, std::uint64_t stream) : key_(mixed(mixed(seed) + stream)) {}
  [[nodiscard]] double at(std::uint64_t index) const {
    return 0x1p-53 * static_cast<double>(mixed(key_ + kStep * index) >> 11);
  }

 private:
  static constexpr std::uint64_t kStep = 0x9E3779B97F4A7C15u;
  static constexpr std::uint64_t mixed(std::uint64_t z) {
    z += kStep;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
    z = (z ^ z >> 27) * 0x94D049BB133111EBu;
    return z ^ z >> 31;
  }
  std::uint64_t key_;
};

/// The area of a surface as a line: its faces one after another, in spatial order, each as long as its area.
/// Where many points fall on a face, its part of the line runs through its halves, quarters and so on, so
/// that near places of the line are near on the surface.
class SurfacePoints {
 public:
  /// Faces with repeated corners are ignored. Must not outlive the mesh.
  explicit SurfacePoints(const Mesh& mesh);

  [[nodiscard]] double area() const { return area_; }
  /// The rounding of areas and their sums, as a fraction of the whole area.
  [[nodiscard]] double rounding() const { return rounding_; }

  struct Place {
    Vec3 at{};
    std::uint32_t face = kNone;
  };
  /// The points of a run of `count` independent ones, uniform by area: along the line, so many that a run
  /// takes little memory.
  class Runs {
   public:
    [[nodiscard]] std::size_t size() const { return first_.size() - 1; }
    [[nodiscard]] std::size_t first(std::size_t run) const { return first_[run]; }
    /// Replaces what is in `places`.
    void place(std::size_t run, std::vector<Place>& places) const;

   private:
    friend class SurfacePoints;
    Runs(const SurfacePoints& surface, std::size_t count, std::uint64_t seed, std::uint64_t stream);
    const SurfacePoints& surface_;
    RandomNumbers numbers_;
    std::vector<std::size_t> first_;  // of each run, and the number of all
  };
  /// The points depend on the seed and the stream.
  [[nodiscard]] Runs runs(std::size_t count, std::uint64_t seed, std::uint64_t stream) const {
    return {*this, count, seed, stream};
  }

 private:
  [[nodiscard]] Place place(double along, double u, double v, std::size_t count) const;

  const Mesh& mesh_;
  std::vector<std::uint32_t> faces_;
  std::vector<double> end_;  // of each of them on the line
  double area_ = 0, rounding_ = 0;
};

}  // namespace sdm::metrics
