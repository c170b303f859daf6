// Draws the sites' polygons on planar domains; the depth test keeps the closest site at each texel.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "gl/device/context.h"
#include "gl/image_size.h"
#include "gl/polygons/raster_polygon.h"
#include "gl/raster_report.h"

namespace sdm::gl {

/// Which texels a domain's polygons may cover. Domains that share an image own disjoint texels.
struct WholeImage {};  ///< a single domain that owns all texels
struct OwnerTable {
  std::span<const std::uint32_t> owners;  ///< the domain of each texel, which the fragment shader looks up
};
struct StencilValues {
  std::span<const std::uint32_t> offsets, texels;  ///< texels of each domain, in compressed rows
  int values;                                      ///< stencil values that domains share, in [1, 255] (4.1)
};
using Ownership = std::variant<WholeImage, OwnerTable, StencilValues>;

/// Row 0 first.
struct RasterImage {
  std::vector<std::uint32_t> winners;  ///< RasterPolygon::winner of the closest site, or kNone
  std::vector<float> depths;  ///< the distance drawn, in units of RasterRules; 1 where nothing was drawn
};

/// Per-device state: the context and the programs.
class RasterDevice {
 public:
  /// Throws sdm::Error if there is no such device, or it rejects a shader.
  explicit RasterDevice(std::string_view wanted);
  ~RasterDevice();

  [[nodiscard]] const Context& context() const { return context_; }

 private:
  friend class Rasteriser;
  struct Programs;
  Context context_;
  std::unique_ptr<Programs> programs_;
};

/// An image on a device: depth and stencil, and the closest site's face. The device's context must be
/// current for its whole lifetime.
class Rasteriser {
 public:
  /// Clears all texels to infinite distance. `owned` must outlive it. Throws sdm::Error if the device cannot
  /// allocate the image.
  Rasteriser(const RasterDevice& device, const ImageSize& size, const Ownership& owned);
  ~Rasteriser();

  /// Throws sdm::Error if a side exceeds that of the device's largest image.
  static void check_size(const Context& context, const ImageSize& size);

  /// Draws each domain's polygons in the order of the batch. On return the device may still be drawing this
  /// batch, but has finished the previous one. Throws sdm::Error.
  void draw(const RasterBatch& batch);

  /// Reads the result. Waits for the device.
  [[nodiscard]] RasterImage read_back();

  /// Adds the fragment, batch and stencil counts so far to the report. Waits for the device.
  void count_into(RasterReport& report);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sdm::gl
