// Placing the shapes of charts in the atlas.
#pragma once

#include <sdm/error.h>
#include <sdm/execution.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "atlas/charts/shape.h"
#include "atlas/packing/footprint.h"

namespace sdm::atlas {

/// The atlas cannot be laid out at this resolution; a larger one may suffice.
class TooSmall : public Error {
 public:
  TooSmall(const std::string& message, std::uint64_t enough)
      : Error(message, Remedy::resolution), enough_(enough) {}
  /// About the smallest resolution that would suffice.
  [[nodiscard]] std::uint64_t enough() const { return enough_; }

 private:
  std::uint64_t enough_;
};

/// Atlas coordinates of a shape point q: matrix · q + offset, the matrix a scale times quarter turns.
struct Placement {
  std::array<Vec2, 2> matrix{};  ///< rows
  Vec2 offset{};

  [[nodiscard]] Vec2 apply(const Vec2& q) const;
};

/// The placement of a footprint's shape: turned, with the corner of its rectangle at the texel `corner`.
[[nodiscard]] Placement placement_of(const Footprint& footprint, unsigned quarter_turns, double scale,
                                     const Vec2& corner);

struct PackOptions {
  std::uint32_t resolution = 0, gutter = 0;
  bool many_small = false;  ///< prefers speed over filling the last gaps, as it does anyway for many shapes
};

/// Places all shapes at one scale, the largest that is found to fit, each with its own ring of `gutter` free
/// texels and owning at least one texel. Throws sdm::Error if the resolution is too small for so many charts,
/// or if there is not enough memory. Deterministic. `progress` receives fractions that never decrease. Cost:
/// several packings, each about linear in texels and faces.
[[nodiscard]] std::vector<Placement> pack(std::span<const Shape> shapes, const PackOptions& options,
                                          const Progress& progress);

}  // namespace sdm::atlas
