// Shader programs, from the sources embedded by the build.
#pragma once

#include <epoxy/gl.h>

#include "core/embedded_file.h"

namespace sdm::gl {

/// GLSL. The build embeds the files of shaders/ (shaders.h, generated).
using ShaderSource = EmbeddedFile;

/// A linked vertex and fragment shader. Needs a current context for its whole lifetime.
class Program {
 public:
  /// Throws sdm::Error if compilation fails, with the names of the files and the device and the compiler's
  /// message.
  Program(const ShaderSource& vertex, const ShaderSource& fragment);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  [[nodiscard]] GLuint id() const { return id_; }
  /// Returns the location of a uniform. Throws sdm::Error if the program does not use it.
  [[nodiscard]] GLint uniform(const char* name) const;
  /// Releases ownership after the context, and the program with it, is gone.
  void forget() { id_ = 0; }

 private:
  GLuint id_ = 0;
};

}  // namespace sdm::gl
