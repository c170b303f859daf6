#include "gl/raster_piece.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <numeric>

namespace sdm::gl {

RasterPiece::RasterPiece() {
  glVertexArrayVertexBuffer(vertex_array_, 0, corners_, 0, sizeof(RasterCorner));
  glVertexArrayElementBuffer(vertex_array_, triangles_);
  glEnableVertexArrayAttrib(vertex_array_, 0);
  glEnableVertexArrayAttrib(vertex_array_, 1);
  glVertexArrayAttribFormat(vertex_array_, 0, 2, GL_FLOAT, GL_FALSE, offsetof(RasterCorner, u));
  glVertexArrayAttribIFormat(vertex_array_, 1, 1, GL_UNSIGNED_INT, offsetof(RasterCorner, polygon));
  for (const GLuint attribute : {0u, 1u}) glVertexArrayAttribBinding(vertex_array_, attribute, 0);
}

std::size_t RasterPiece::limit(const Context& context) {
  constexpr std::size_t kMost = 1 << 16;
  return std::min(kMost, static_cast<std::size_t>(context.max_texture_buffer_size()) / kTexelsPerPolygon);
}

void RasterPiece::set(const RasterBatch& batch, std::size_t begin, std::size_t end, Order order,
                      const Program& program) {
  upload(polygons_, std::span(batch.polygons).subspan(begin, end - begin));
  const std::size_t first = batch.first_corner[begin];
  upload(corners_, std::span(batch.corners).subspan(first, batch.first_corner[end] - first));

  order_.resize(end - begin);
  std::iota(order_.begin(), order_.end(), static_cast<std::uint32_t>(begin));
  const auto domain = [&](std::uint32_t polygon) { return batch.polygons[polygon].domain; };
  if (order == Order::by_domain) std::ranges::stable_sort(order_, std::ranges::less{}, domain);
  if (order == Order::by_domain_reversed) std::ranges::stable_sort(order_, std::ranges::greater{}, domain);
  indices_.clear();
  for (const std::uint32_t polygon : order_) {
    const auto from = static_cast<std::uint32_t>(batch.first_corner[polygon] - first);
    const auto to = static_cast<std::uint32_t>(batch.first_corner[polygon + 1] - first);
    for (std::uint32_t c = from + 1; c + 1 < to; ++c) indices_.insert(indices_.end(), {from, c, c + 1});
  }
  upload(triangles_, std::span<const std::uint32_t>(indices_));

  glTextureBuffer(table_, GL_RGBA32UI, polygons_);
  glBindTextureUnit(0, table_);
  glProgramUniform1ui(program.id(), program.uniform("first_polygon"), static_cast<GLuint>(begin));
}

void RasterPiece::draw(std::size_t first_index, std::size_t count) const {
  // NOLINTNEXTLINE(performance-no-int-to-ptr): OpenGL takes offsets as pointers
  const auto* offset = reinterpret_cast<const void*>(first_index * sizeof(std::uint32_t));
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(count), GL_UNSIGNED_INT, offset);
}

}  // namespace sdm::gl
