// Draws polygons of Algorithm 1 into the atlas, clipped to faces by a stencil; the depth test keeps the
// closest site at each texel.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "gl/device/context.h"
#include "gl/raster_report.h"
#include "gl/rasteriser.h"
#include "research/literal/corrections.h"
#include "research/literal/printed_polygons.h"

namespace sdm::literal {

struct Stencil {
  gl::StencilValues values;
  /// Three of each face's triangle, which is drawn in place of its texels, as in the paper; may be empty.
  std::span<const std::array<float, 2>> corners{};
};

/// Row 0 first.
struct Image {
  std::vector<std::uint32_t> winners;         ///< of the closest site, or kNone
  std::vector<float> depths;                  ///< the distance drawn; 1 where nothing was drawn
  std::vector<std::array<float, 4>> vectors;  ///< the distance vector drawn; empty with confirmation
};

/// The context and the programs.
class Device {
 public:
  /// Throws sdm::Error if there is no such device, or it rejects a shader.
  explicit Device(std::string_view wanted);
  ~Device();

  [[nodiscard]] const gl::Context& context() const { return context_; }

 private:
  friend class Rasteriser;
  struct Programs;
  gl::Context context_;
  std::unique_ptr<Programs> programs_;
};

/// An image on a device, whose context must be current for its whole lifetime.
class Rasteriser {
 public:
  /// Clears all texels to infinite distance. `stencil` must outlive it. Throws sdm::Error if the device
  /// cannot allocate the image.
  Rasteriser(const Device& device, const gl::ImageSize& size, const Stencil& stencil,
             const Corrections& corrections);
  ~Rasteriser();

  /// Throws sdm::Error.
  void draw(const PrintedBatch& batch);
  /// Reads the result. Waits for the device.
  [[nodiscard]] Image read_back();
  void count_into(gl::RasterReport& report) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sdm::literal
