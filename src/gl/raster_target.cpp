#include "gl/raster_target.h"

#include <sdm/error.h>
#include <sdm/types.h>

#include <array>
#include <utility>

#include "atlas/layout.h"

namespace sdm::gl {

RasterTarget::RasterTarget(const Context& context, const ImageSize& size) : context_(context), size_(size) {
  const auto columns = static_cast<GLsizei>(size.columns), rows = static_cast<GLsizei>(size.rows);
  glTextureStorage2D(winners_, 1, GL_R32UI, columns, rows);
  glTextureStorage2D(depth_, 1, GL_DEPTH32F_STENCIL8, columns, rows);
  glNamedFramebufferTexture(framebuffer_, GL_COLOR_ATTACHMENT0, winners_, 0);
  glNamedFramebufferTexture(framebuffer_, GL_DEPTH_STENCIL_ATTACHMENT, depth_, 0);
}

void RasterTarget::check_complete() const {
  context_.check("allocating a map of " + atlas::size_text(size_.columns, size_.rows) + " texels");
  if (glCheckNamedFramebufferStatus(framebuffer_, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw Error(context_.device().name +
                " cannot draw into a 32-bit depth buffer with stencil; use another device or engine");
}

void RasterTarget::clear() const {
  glDisable(GL_SCISSOR_TEST);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthMask(GL_TRUE);
  glStencilMask(0xFF);
  const std::array<GLuint, 4> nothing{kNone, 0, 0, 0};
  glClearNamedFramebufferuiv(framebuffer_, GL_COLOR, 0, nothing.data());
  glClearNamedFramebufferfi(framebuffer_, GL_DEPTH_STENCIL, 0, 1.0f, 0);
}

void RasterTarget::begin(bool with_stencil) const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glViewport(0, 0, static_cast<GLsizei>(size_.columns), static_cast<GLsizei>(size_.rows));
  glDisable(GL_SCISSOR_TEST);
  with_stencil ? glEnable(GL_STENCIL_TEST) : glDisable(GL_STENCIL_TEST);
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_LESS);
}

void RasterTarget::end() {
  const Fence before = std::exchange(last_, Fence::after_all_commands());
  before.wait();
  context_.check("drawing the polygons");
}

void RasterTarget::read(std::vector<std::uint32_t>& winners, std::vector<float>& depths) const {
  read_texels(winners_, size_, GL_RED_INTEGER, GL_UNSIGNED_INT, winners);
  read_texels(depth_, size_, GL_DEPTH_COMPONENT, GL_FLOAT, depths);
}

}  // namespace sdm::gl
