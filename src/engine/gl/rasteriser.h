// Draws the polygons of sites on planar domains; the depth test keeps the closest at each texel.
#pragma once

#include <sdm/gl.h>

#include <cstdint>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "engine/gl/device/context.h"
#include "engine/gl/raster_polygon.h"

namespace sdm::gl {

/// Which texels a domain's polygons may reach. Domains that share an image own disjoint texels.
struct WholeImage {};  ///< one domain that owns them all
struct OwnerTable {
  std::span<const std::uint32_t> owners;  ///< the domain of each texel: fragments ask
};
struct StencilValues {
  std::span<const std::uint32_t> offsets, texels;  ///< texels of each domain, in compressed rows
  int values;                                      ///< that domains share, in [1, 255] (4.1)
};
using Ownership = std::variant<WholeImage, OwnerTable, StencilValues>;

/// Row 0 first.
struct RasterImage {
  std::vector<std::uint32_t> faces;  ///< of O2, that the closest site belongs to, or kNone
  std::vector<float> depths;         ///< the distance drawn, in units of RasterScale; 1 where there is none
};

/// Per-device state: the context and the programs.
class RasterDevice {
 public:
  /// Throws sdm::Error where there is no such device, or it refuses a shader.
  explicit RasterDevice(std::string_view wanted);
  ~RasterDevice();

  [[nodiscard]] const Context& context() const { return context_; }

 private:
  friend class Rasteriser;
  struct Programs;
  Context context_;
  std::unique_ptr<Programs> programs_;
};

/// One square image on a device: depth and stencil, the closest site's face. The device's context must be
/// current for its whole life.
class Rasteriser {
 public:
  /// All texels infinitely far. `owned` must outlive it. Throws sdm::Error when the device cannot hold the
  /// image.
  Rasteriser(const RasterDevice& device, std::uint32_t resolution, const Ownership& owned);
  ~Rasteriser();

  /// Throws sdm::Error for a resolution larger than the device's images.
  static void check_size(const Context& context, std::uint32_t resolution);

  /// Draws in the order of the batch, on each domain. The device may still be drawing this batch on return,
  /// but has finished the previous one. Throws sdm::Error.
  void draw(const RasterBatch& batch);

  /// Returns the drawn result. Waits for the device.
  [[nodiscard]] RasterImage read_back();

  /// Adds fragments, batches and stencil counts so far. Waits for the device.
  void count_into(GlReport& report);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sdm::gl
