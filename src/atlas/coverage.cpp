#include "atlas/coverage.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "atlas/face_frame.h"
#include "atlas/surface_impl.h"
#include "core/parallel.h"
#include "core/vec.h"

namespace sdm {
namespace {

/// A float that is not less.
float rounded_up(double x) {
  return static_cast<float>(x * (1 + 0x1p-23));
}

/// A maximum over all faces: whichever comes first, the result is the same.
void raise(float& radius, float value) {
  const std::atomic_ref<float> shared(radius);
  float current = shared.load(std::memory_order_relaxed);
  while (value > current && !shared.compare_exchange_weak(current, value, std::memory_order_relaxed)) {
  }
}

}  // namespace

double half_diagonal(const std::array<Vec3, 2>& texel_edges) {
  const auto& [du, dv] = texel_edges;
  return 0.5 * std::sqrt(std::max(squared_norm(du + dv), squared_norm(du - dv)));
}

// The passes of `measure`; each goes over all faces or samples.
struct Coverage::Measuring {
  const Coverage& coverage;
  const Surface& surface;
  Radii& radii;

  // A texel's square on the face, plus what M⁻¹, which places the samples, moves the face's own corners by
  // rounding.
  void squares_of_face(std::size_t face) const {
    radii.faces[face] = 0;
    if (!coverage.has_squares_[face]) return;
    const FaceFrame frame(surface.mesh(), face);
    const FaceMap& map = surface.impl().maps[face];
    const auto& [du, dv] = map.edges;
    double mismatch = 0;
    for (int k = 0; k < 2; ++k) {
      const Vec2 d = surface.impl().corners[face][k + 1] - map.origin;
      mismatch = std::max(mismatch, norm(d[0] * du + d[1] * dv - frame.edges[k]));
    }
    radii.faces[face] = rounded_up(half_diagonal(map.edges) + mismatch + frame.rounding());
  }

  void square_of_sample(std::size_t sample) const {
    const std::uint32_t face = coverage.square_faces_[sample];
    radii.samples[sample] = face == kNone ? 0 : radii.faces[face];
  }

  void pieces_of_block(const Block& block) const {
    std::array<double, 256> squared;
    std::size_t first = 0;
    for (const auto& [face, end] : block.faces) {
      const FaceFrame frame(surface.mesh(), face);
      const double rounding = frame.rounding();
      float largest = radii.faces[face];
      while (first < end) {
        const std::size_t count = std::min(squared.size(), end - first);
        const std::span<const Piece> pieces(block.pieces.data() + first, count);
        measure_pieces(pieces, frame.origin, frame.edges, surface.sample_points(), squared);
        for (std::size_t i = 0; i < count; ++i) {
          const float radius = rounded_up(std::sqrt(squared[i]) + rounding);
          raise(radii.samples[pieces[i].sample], radius);
          largest = std::max(largest, radius);
        }
        first += count;
      }
      radii.faces[face] = largest;
    }
  }
};

void Coverage::measure(const Surface& surface, Radii& radii) const {
  radii.faces.resize(has_squares_.size());
  radii.samples.resize(square_faces_.size());
  const Measuring measuring{*this, surface, radii};
  parallel_for(radii.faces.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t face = begin; face < end; ++face) measuring.squares_of_face(face);
  });
  parallel_for(radii.samples.size(), 1 << 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t sample = begin; sample < end; ++sample) measuring.square_of_sample(sample);
  });
  parallel_for(blocks_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t block = begin; block < end; ++block) measuring.pieces_of_block(blocks_[block]);
  });
  radii.largest = *std::ranges::max_element(radii.faces);
}

}  // namespace sdm
