#include "io/mesh/frames/welded_frames.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include "geometry/vec.h"
#include "mesh/validate.h"

namespace sdm::io {

WeldedFrames::WeldedFrames(FrameSource& source, const PolygonMesh& polygons)
    : source_(source), mesh_(to_mesh(polygons, renumbered_)) {
  constexpr double kWeld = 1e-6;
  weld_tolerance_ = kWeld * diagonal(bounds(mesh_));
}

void WeldedFrames::begin() {
  const auto first = read(0);
  mesh_.positions.assign(first.begin(), first.end());
  validate(mesh_);
}

std::span<const Vec3> WeldedFrames::read(std::size_t frame) {
  source_.read(frame, file_positions_);
  positions_.resize(mesh_.positions.size());
  std::size_t found = 0;  // vertices are numbered in the order of the files
  for (std::size_t v = 0; v < file_positions_.size(); ++v) {
    const std::uint32_t vertex = renumbered_[v];
    if (vertex == kNone) continue;
    if (!finite(file_positions_[v]))
      throw Error(fmt::format("vertex {} has a NaN or infinite coordinate", v));
    if (vertex == found)
      positions_[found++] = file_positions_[v];
    else if (norm(file_positions_[v] - positions_[vertex]) > weld_tolerance_)
      throw Error(
          fmt::format("vertex {} has moved away from one that it coincides with in the first frame; such "
                      "vertices must stay "
                      "together",
                      v));
  }
  mesh::validate_positions(positions_);
  return positions_;
}

}  // namespace sdm::io
