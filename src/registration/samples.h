// Samples of O1, in an order that keeps neighbours together.
#pragma once

#include <sdm/mesh.h>

#include <functional>
#include <span>
#include <vector>

namespace sdm::registration {

struct Samples {
  std::vector<Vec3> points;
  std::vector<Vec3> normals;  ///< of unit length or zero; empty if unknown
};

/// Returns samples, at most `count`; the same for the same count.
using SampleSource = std::function<Samples(std::size_t count)>;

/// Samples of equal shares of the area. The mesh must be valid and outlive the source.
[[nodiscard]] SampleSource surface_source(const Mesh& mesh);
/// A pseudorandom subset. The arrays must outlive the source.
[[nodiscard]] SampleSource cloud_source(std::span<const Vec3> points, std::span<const Vec3> normals);

}  // namespace sdm::registration
