// The tree and the faces of Sites, as shaders/faces.wgsl reads them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sites/sites_data.h"

namespace sdm::gpu {

struct ChildBox {
  float lower[3];
  std::uint32_t number;
  float upper[3];
  std::uint32_t padding;
};
struct Face {
  float origin_length[4], along_ac[4], beside_ac[4], normal_ac[4], bc[4];
};
struct Errors {
  float by_coordinate, constant, padding[2];
};
static_assert(sizeof(ChildBox) == 32 && sizeof(Face) == 80 && sizeof(Errors) == 16);

/// The eight-wide tree and a frame of each face, in single precision in the unit frame of the sites: of some
/// leaves that follow each other, as many as have room in buffers of so many bytes, with the nodes above
/// them.
struct PackedSites {
  /// Throws sdm::Error if there is not enough memory.
  PackedSites(const sites::SitesData& sites, std::uint32_t first_leaf, std::size_t most_bytes);

  std::uint32_t first;     ///< of its faces, in the order of the leaves of all
  std::uint32_t end_leaf;  ///< with which the next part begins; kNone: there is none
  std::vector<ChildBox> boxes;
  std::vector<std::uint32_t> leaves;  ///< the first face of each, and an end
  std::vector<Face> faces;
};

[[nodiscard]] Errors errors_of(const sites::SitesData& sites);

/// The error of a distance that a device has computed, in the unit frame: at most `each` of itself, and
/// `constant`, of a point whose coordinates are at most this. See docs/design/gpu.md.
struct DistanceError {
  double each, constant;
};
[[nodiscard]] DistanceError distance_error(const sites::SitesData& sites, double largest_coordinate);
/// The same for samples that the device has placed by vertices whose coordinates are at most this.
[[nodiscard]] DistanceError sample_error(const sites::SitesData& sites, double largest_coordinate);

}  // namespace sdm::gpu
