// The frames of a source as the positions of one mesh.
#pragma once

#include <sdm/mesh.h>

#include <cstdint>
#include <span>
#include <vector>

#include "io/mesh/frames/frame_source.h"

namespace sdm::io {

/// Vertices that coincide in the first frame are one vertex in all of them.
class WeldedFrames {
 public:
  /// `polygons`: of the source. Throws sdm::Error as to_mesh() does; the message does not name the frame.
  WeldedFrames(FrameSource& source, const PolygonMesh& polygons);
  /// Reads the first frame, whose positions are those of mesh() then. Throws sdm::Error as read() and
  /// validate() do.
  void begin();

  [[nodiscard]] const Mesh& mesh() const { return mesh_; }
  /// Returns the positions of a frame, one for each vertex of mesh(), valid until the next call. Throws
  /// sdm::Error for coordinates that validate() refuses, and if vertices that are one have different
  /// positions.
  [[nodiscard]] std::span<const Vec3> read(std::size_t frame);

 private:
  FrameSource& source_;
  std::vector<std::uint32_t> renumbered_;  // the vertex of mesh_ for each vertex in the files, or kNone
  Mesh mesh_;                              // the first frame
  double weld_tolerance_ = 0;              // how far apart welded vertices may move
  std::vector<Vec3> file_positions_, positions_;
};

}  // namespace sdm::io
