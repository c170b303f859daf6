// Shader programs, from the sources that the build embeds.
#pragma once

#include <epoxy/gl.h>

#include "core/embedded_file.h"

namespace sdm::gl {

/// GLSL. The build embeds the files of shaders/ (shaders.h, generated).
using ShaderSource = EmbeddedFile;

/// A vertex and a fragment shader, linked. Needs a current context, for its whole life.
class Program {
 public:
  /// Throws sdm::Error with the names of the files and the device and the compiler's message if compilation
  /// fails.
  Program(const ShaderSource& vertex, const ShaderSource& fragment);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  [[nodiscard]] GLuint id() const { return id_; }
  /// The location of a uniform, which must be in use, else sdm::Error.
  [[nodiscard]] GLint uniform(const char* name) const;
  /// For when the context is gone, and has taken it along.
  void forget() { id_ = 0; }

 private:
  GLuint id_ = 0;
};

}  // namespace sdm::gl
