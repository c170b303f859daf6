// Normals that normal textures bend.
#pragma once

#include <sdm/bake.h>

#include <array>
#include <optional>
#include <vector>

#include "baking/look_reader.h"
#include "map/transfer/corner_normals.h"

namespace sdm::baking {

/// The normal textures of a mesh. Without MikkTSpace, and where no material has one with a picture, there are
/// none.
class NormalTextures {
 public:
  /// All must outlive this. Cost: that of MikkTSpace for the faces that have such a texture.
  NormalTextures(const Mesh& mesh, const MeshLook& look, const map::CornerNormals& normals);

  /// Reads at points, each thread with a reader of its own.
  class Reader {
   public:
    explicit Reader(const NormalTextures& textures);
    /// The normal at a point, of which `normal` is the interpolated one, averaged over the parallelogram of
    /// the sides. Of length 1.
    [[nodiscard]] Vec3 at(const SurfacePoint& point, const std::array<Vec3, 2>& sides, const Vec3& normal);

   private:
    const NormalTextures& textures_;
    std::optional<LookReader> reader_;
  };

 private:
  Pictures pictures_;
  std::optional<ChannelLook> look_;            ///< nothing: there are none
  std::vector<std::array<Vec3, 3>> tangents_;  ///< at the corners of faces
  std::vector<std::array<float, 3>> signs_;    ///< of the bitangents
};

}  // namespace sdm::baking
