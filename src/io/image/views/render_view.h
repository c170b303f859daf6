// A shaded picture of O1, coloured by distance, with O2 as a ghost.
#pragma once

#include <sdm/surface.h>

#include <span>
#include <vector>

#include "io/image/pictures/face_scales.h"
#include "io/image/pictures/picture.h"
#include "io/image/views/depth_buffer.h"
#include "io/mesh/model/shading_normals.h"

namespace sdm::io {

/// The background of views, and the colour of O2 where it is lit.
inline constexpr Rgb kViewBackground{240, 241, 243}, kGhost{203, 208, 215};

/// What is drawn.
struct ViewScene {
  const Surface* surface = nullptr;
  const ShadingNormals* normals = nullptr;
  std::span<const float> distances{};         ///< of each texel
  std::span<const float> vertex_distances{};  ///< shown where a face has no texel
  ColorScale scale{};                         ///< of O2's distances
  const FaceScales* of_faces = nullptr;       ///< of those of O1
  const Mesh* other = nullptr;                ///< O2, or null
  ShadingNormals other_normals{};
  std::span<const float> other_distances{};  ///< of O2's vertices, which colour it; or empty: it is pale
};

struct View {
  Picture picture;
  std::vector<bool> visible;  ///< of each of `places`: nothing of O1 hides it
  std::vector<double>
      in_front;  ///< of each: how far what hides it is in front of it; ∞ outside of the picture
};

/// Draws O1 shaded, with outlines, and O2 pale: behind O1 and beside it as a body, in front of it as a veil;
/// or both as bodies, if O2 has distances.
/// `places`: points of O1. Cost: linear in faces and pixels; memory for 8 bytes of each sample of the tiles
/// that a mesh covers, and 24 of each vertex.
[[nodiscard]] View render_view(const ViewScene& scene, const Projection& projection,
                               std::span<const Vec3> places);

}  // namespace sdm::io
