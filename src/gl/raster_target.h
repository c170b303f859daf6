// The image that polygons are drawn into: the closest site of each texel, its depth, and a stencil.
#pragma once

#include <epoxy/gl.h>

#include <cstdint>
#include <vector>

#include "gl/device/context.h"
#include "gl/device/gl_objects.h"
#include "gl/image_size.h"

namespace sdm::gl {

/// The context must outlive it and be current for its whole lifetime.
class RasterTarget {
 public:
  /// Throws sdm::Error if the device cannot allocate the image.
  RasterTarget(const Context& context, const ImageSize& size);

  [[nodiscard]] const ImageSize& size() const { return size_; }
  [[nodiscard]] GLuint framebuffer() const { return framebuffer_; }

  /// Throws sdm::Error unless the device can draw into the image, with all that has been attached.
  void check_complete() const;
  /// Clears all texels to no site at infinite distance.
  void clear() const;
  /// Sets the state that no draw changes. The context is shared with other images.
  void begin(bool with_stencil) const;
  /// Submits the draws since begin(). At most two of these are in flight. Throws sdm::Error.
  void end();
  /// Reads the sites and their depths. Waits for the device.
  void read(std::vector<std::uint32_t>& winners, std::vector<float>& depths) const;

 private:
  const Context& context_;
  ImageSize size_;
  Texture<GL_TEXTURE_2D> winners_, depth_;
  Framebuffer framebuffer_;
  Fence last_;  // after the previous end()
};

/// Reads all texels of a texture, in bands of rows: OpenGL counts bytes with 31 bits.
template <class T>
void read_texels(GLuint texture, const ImageSize& size, GLenum format, GLenum type, std::vector<T>& out) {
  out.resize(size.texels());
  const auto columns = static_cast<GLsizei>(size.columns), rows = static_cast<GLsizei>(size.rows);
  const GLsizei band = std::max(1, (1 << 30) / static_cast<GLsizei>(sizeof(T)) / columns);
  for (GLsizei row = 0; row < rows; row += band) {
    const GLsizei count = std::min(band, rows - row);
    glGetTextureSubImage(texture, 0, 0, row, 0, columns, count, 1, format, type,
                         count * columns * static_cast<GLsizei>(sizeof(T)),
                         out.data() + static_cast<std::size_t>(row) * size.columns);
  }
}

}  // namespace sdm::gl
