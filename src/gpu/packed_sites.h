// The tree and the faces of Sites, as shaders/faces.wgsl reads them.
#pragma once

#include <sdm/mesh.h>

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
  float origin_length[4], along_ac[4], beside_ac[4], normal_ac[4], bc[3];
  std::uint32_t number;
};
/// As shaders/face_sites.wgsl reads them.
struct FaceSites {
  Triangle vertices;
  std::array<std::uint32_t, 3> edges;
};
struct Errors {
  float by_coordinate, constant, padding[2];
};
static_assert(sizeof(ChildBox) == 32 && sizeof(Face) == 80 && sizeof(Errors) == 16 &&
              sizeof(FaceSites) == 24);

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
  std::vector<FaceSites> face_sites;
  std::vector<std::uint32_t> nodes;         ///< the deepest first, so that a refit has their children before
  std::vector<std::uint32_t> level_counts;  ///< how many of them each level has
};

/// What the error of distances to a shape follows from. See docs/design/gpu.md.
struct ShapeErrors {
  double each;      ///< of the distance
  double constant;  ///< twice that of the faces of the shape

  ShapeErrors(double by_distance, double of_faces) : each(by_distance), constant(of_faces) {}
  /// Of faces whose frames the processor has computed.
  ShapeErrors(const sites::SitesData& sites);  // NOLINT(google-explicit-constructor)
};
/// Of faces whose frames a device has computed, which has left `constant`.
[[nodiscard]] ShapeErrors refitted_errors(const Errors& left);
/// What the shaders are given.
[[nodiscard]] Errors errors_of(const ShapeErrors& shape);

/// The error of a distance that a device has computed, in the unit frame: at most `each` of itself, and
/// `constant`, of a point whose coordinates are at most this.
struct DistanceError {
  double each, constant;
};
[[nodiscard]] DistanceError distance_error(const ShapeErrors& shape, double largest_coordinate);
/// The same for samples that the device has placed by vertices whose coordinates are at most this.
[[nodiscard]] DistanceError sample_error(const ShapeErrors& shape, double largest_coordinate);

}  // namespace sdm::gpu
