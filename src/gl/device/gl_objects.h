// RAII handles of OpenGL objects. All need a current context for their whole lifetime.
#pragma once

#include <epoxy/gl.h>

#include <utility>

namespace sdm::gl {

template <void (*Create)(GLuint&), void (*Delete)(GLuint&)>
class Object {
 public:
  Object() { Create(id_); }
  ~Object() { Delete(id_); }
  Object(const Object&) = delete;
  Object& operator=(const Object&) = delete;

  operator GLuint() const { return id_; }

 private:
  GLuint id_ = 0;
};

namespace detail {
// libepoxy's entry points are variables, which cannot be template arguments.
inline void create_buffer(GLuint& id) {
  glCreateBuffers(1, &id);
}
inline void delete_buffer(GLuint& id) {
  glDeleteBuffers(1, &id);
}
template <GLenum Target>
void create_texture(GLuint& id) {
  glCreateTextures(Target, 1, &id);
}
inline void delete_texture(GLuint& id) {
  glDeleteTextures(1, &id);
}
inline void create_framebuffer(GLuint& id) {
  glCreateFramebuffers(1, &id);
}
inline void delete_framebuffer(GLuint& id) {
  glDeleteFramebuffers(1, &id);
}
inline void create_vertex_array(GLuint& id) {
  glCreateVertexArrays(1, &id);
}
inline void delete_vertex_array(GLuint& id) {
  glDeleteVertexArrays(1, &id);
}
}  // namespace detail

/// A position in the command stream; default-constructed, none.
class Fence {
 public:
  Fence() = default;
  ~Fence() { glDeleteSync(sync_); }
  Fence(Fence&& other) noexcept : sync_(std::exchange(other.sync_, nullptr)) {}
  Fence& operator=(Fence&& other) noexcept {
    std::swap(sync_, other.sync_);
    return *this;
  }

  /// Also flushes the commands, so that the device starts on them.
  [[nodiscard]] static Fence after_all_commands() {
    Fence fence;
    fence.sync_ = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    glFlush();
    return fence;
  }
  /// Waits until the device reaches this position or is lost.
  void wait() const {
    constexpr GLuint64 kSecond = 1'000'000'000;  // in nanoseconds
    while (sync_ != nullptr && glClientWaitSync(sync_, 0, kSecond) == GL_TIMEOUT_EXPIRED)
      if (glGetGraphicsResetStatus() != GL_NO_ERROR) return;
  }

 private:
  GLsync sync_ = nullptr;
};

using Buffer = Object<detail::create_buffer, detail::delete_buffer>;
template <GLenum Target>
using Texture = Object<detail::create_texture<Target>, detail::delete_texture>;
using Framebuffer = Object<detail::create_framebuffer, detail::delete_framebuffer>;
using VertexArray = Object<detail::create_vertex_array, detail::delete_vertex_array>;

}  // namespace sdm::gl
