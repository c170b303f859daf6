// The tree and the faces of Sites on a device.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gpu/device/device.h"
#include "gpu/packed_sites.h"
#include "sites/sites_data.h"

namespace sdm::gpu {

/// What a program is to compute, as in shaders/part.wgsl.
struct PartOfMap {
  std::uint32_t tiles = 0, first = 0, count = 0, has_distances = 0;
};

/// The programs that refit a tree on a device.
struct RefitPrograms {
  explicit RefitPrograms(Device& device);

  Pipeline faces, boxes;
};

/// The eight-wide tree and a frame of each face, in single precision in the unit frame of the sites: as one
/// tree, or as several of some leaves each where the device does not bind as much memory at once.
struct SitesOnDevice {
  /// Throws sdm::Error if there is not enough memory, here or there.
  SitesOnDevice(Device& device, const sites::SitesData& sites);

  /// Whether the faces and the tree are still these, whatever the positions. Cost: linear, some 20 bytes a
  /// face.
  [[nodiscard]] bool has_tree_of(const sites::SitesData& sites) const;
  /// The unit frame of the faces with their vertices at these positions. Throws sdm::Error for another number
  /// of vertices.
  [[nodiscard]] UnitFrame frame_of(std::span<const Vec3> positions) const;
  /// Moves the vertices: only these are uploaded, and the tree is refitted on the device. Throws sdm::Error,
  /// and changes nothing, if one is not finite; or if the device fails. Cost: linear.
  void refit(Device& device, const RefitPrograms& programs, std::span<const Vec3> positions,
             const UnitFrame& moved);

  struct Level {
    Buffer constants;
    std::uint32_t nodes;
  };
  struct Part {
    std::uint32_t first;  ///< of its faces, in the order of the leaves of all
    Buffer boxes, leaves, faces, face_sites, nodes;
    Level all_faces;  ///< as the constants of a refit
    std::vector<Level> levels;
  };

  std::uint64_t shape_number;  ///< of SitesData
  UnitFrame frame;
  ShapeErrors shape;
  Buffer errors;
  std::vector<Part> parts;

 private:
  std::vector<Triangle> triangles_;              // of the mesh
  std::vector<std::uint32_t> items_, children_;  // of the trees
  std::vector<std::uint8_t> used_;               // whether a vertex belongs to a face
  Buffer positions_, read_back_;                 // made by the first refit
};

}  // namespace sdm::gpu
