// OpenGL objects that delete themselves. All need a current context for their whole life.
#pragma once

#include <epoxy/gl.h>

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
// libepoxy's entry points are variables, which templates cannot name.
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

using Buffer = Object<detail::create_buffer, detail::delete_buffer>;
template <GLenum Target>
using Texture = Object<detail::create_texture<Target>, detail::delete_texture>;
using Framebuffer = Object<detail::create_framebuffer, detail::delete_framebuffer>;
using VertexArray = Object<detail::create_vertex_array, detail::delete_vertex_array>;

}  // namespace sdm::gl
