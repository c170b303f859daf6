// Polygons on the device, as triangles in the order in which they are drawn.
#pragma once

#include <epoxy/gl.h>

#include <cstdint>
#include <span>
#include <vector>

#include "gl/device/context.h"
#include "gl/device/gl_objects.h"
#include "gl/device/program.h"
#include "gl/polygons/raster_polygon.h"

namespace sdm::gl {

/// The corners of a polygon of a batch.
[[nodiscard]] inline std::span<const RasterCorner> corners_of(const RasterBatch& batch, std::size_t polygon) {
  return {batch.corners.data() + batch.first_corner[polygon],
          batch.corners.data() + batch.first_corner[polygon + 1]};
}

/// Replaces the contents of a buffer. Allocates new storage each time: the device may still be drawing from
/// the old one.
template <class T>
void upload(GLuint buffer, std::span<const T> data) {
  glNamedBufferData(buffer, static_cast<GLsizeiptr>(data.size_bytes()), data.data(), GL_STREAM_DRAW);
}

/// A piece of a batch, which a draw call takes. Its vertex array has the corners, as attributes 0 and 1, and
/// the triangles.
class RasterPiece {
 public:
  enum class Order { as_given, by_domain, by_domain_reversed };

  RasterPiece();
  /// The most polygons that a piece has on a device.
  [[nodiscard]] static std::size_t limit(const Context& context);

  [[nodiscard]] GLuint vertex_array() const { return vertex_array_; }

  /// Uploads polygons begin ... end − 1, and sets the program's uniform and texture unit 0 for them.
  void set(const RasterBatch& batch, std::size_t begin, std::size_t end, Order order, const Program& program);
  /// Draws all polygons by one call.
  void draw() const { draw(0, indices_.size()); }
  /// Draws those of each domain by one call, after prepare(domain): its stencil value is valid for the whole
  /// call. Requires an order by domains.
  template <class Prepare>
  void draw_by_domain(const RasterBatch& batch, const Prepare& prepare) const;

 private:
  void draw(std::size_t first_index, std::size_t count) const;

  Buffer polygons_, corners_, triangles_;
  Texture<GL_TEXTURE_BUFFER> table_;
  VertexArray vertex_array_;
  std::vector<std::uint32_t> order_, indices_;
};

template <class Prepare>
void RasterPiece::draw_by_domain(const RasterBatch& batch, const Prepare& prepare) const {
  std::size_t first_index = 0;
  for (std::size_t i = 0; i < order_.size();) {
    const std::uint32_t domain = batch.polygons[order_[i]].domain;
    std::size_t count = 0;
    for (; i < order_.size() && batch.polygons[order_[i]].domain == domain; ++i)
      count += 3 * (corners_of(batch, order_[i]).size() - 2);
    prepare(domain);
    draw(first_index, count);
    first_index += count;
  }
}

}  // namespace sdm::gl
