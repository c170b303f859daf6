#include "surface/sampling_bound/piece_assignment.h"

#include <algorithm>
#include <cmath>

#include "core/atomic_extremes.h"
#include "core/parallel.h"
#include "geometry/vec.h"
#include "surface/sample_blocks.h"
#include "surface/sampling_bound/face_frame.h"
#include "surface/surface_data.h"

namespace sdm::surface {

float rounded_up(double x) {
  return static_cast<float>(x * (1 + 0x1p-23));
}

double half_diagonal(const std::array<Vec3, 2>& texel_edges) {
  const auto& [du, dv] = texel_edges;
  return 0.5 * std::sqrt(std::max(squared_norm(du + dv), squared_norm(du - dv)));
}

double square_radius(const Surface& surface, std::uint32_t face, const FaceFrame& frame) {
  const atlas::FaceMap& map = internals(surface).maps[face];
  const auto& [du, dv] = map.edges;
  double mismatch = 0;
  for (int k = 0; k < 2; ++k) {
    const Vec2 d = internals(surface).corners[face][k + 1] - map.origin;
    mismatch = std::max(mismatch, norm(d[0] * du + d[1] * dv - frame.edges[k]));
  }
  return half_diagonal(map.edges) + mismatch + frame.rounding();
}

// Calls take_face(face, radius) for each face in the block: no point of its pieces here is farther from its
// sample.
template <class Take>
void PieceAssignment::measure_block(const Surface& surface, std::size_t block, std::span<const Vec3> points,
                                    std::span<float> radii, const Take& take_face) const {
  std::ranges::fill(radii, 0.0f);
  for_each_face(block, [&](const FaceInBlock& part, auto squares, std::span<const Piece> pieces) {
    const FaceFrame frame(surface.mesh(), part.face);
    float largest = 0;
    if (!squares.empty()) {
      largest = rounded_up(square_radius(surface, part.face, frame));
      for (const std::uint8_t sample : squares) radii[sample] = std::max(radii[sample], largest);
    }
    const double rounding = frame.rounding();
    for (std::array<double, 64> squared; !pieces.empty();) {
      const auto some = pieces.first(std::min(squared.size(), pieces.size()));
      measure_pieces(some, frame.origin, frame.edges, points, squared);
      for (std::size_t i = 0; i < some.size(); ++i) {
        const float radius = rounded_up(std::sqrt(squared[i]) + rounding);
        radii[some[i].sample] = std::max(radii[some[i].sample], radius);
        largest = std::max(largest, radius);
      }
      pieces = pieces.subspan(some.size());
    }
    take_face(part.face, largest);
  });
}

void PieceAssignment::measure(const Surface& surface, Radii& radii) const {
  const std::size_t samples = surface.sample_texels().size();
  radii.faces.assign(surface.mesh().triangles.size(), 0);
  radii.samples.resize(samples);
  const auto take_face = [&](std::uint32_t face, float largest) { atomic_max(radii.faces[face], largest); };
  parallel_for(block_count(samples), 16, [&](std::size_t begin, std::size_t end) {
    std::array<Vec3, kBlockSize> places;
    for (std::size_t b = begin; b < end; ++b) {
      const SampleBlock block(b, samples);
      const std::span points = std::span(places).first(block.size());
      internals(surface).place_samples(block.first, points);
      measure_block(surface, b, points, std::span(radii.samples).subspan(block.first, block.size()),
                    take_face);
    }
  });
  radii.largest = *std::ranges::max_element(radii.faces);
}

}  // namespace sdm::surface
