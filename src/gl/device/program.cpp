#include "gl/device/program.h"

#include <sdm/error.h>

#include <algorithm>
#include <string>

namespace sdm::gl {
namespace {

/// A driver's log, on one line.
template <class GetLog>
std::string log_of(GLuint object, GetLog get_log) {
  std::string text(1000, '\0');
  GLsizei length = 0;
  get_log(object, static_cast<GLsizei>(text.size()), &length, text.data());
  text.resize(static_cast<std::size_t>(std::max(length, 0)));
  while (!text.empty() && (text.back() == '\n' || text.back() == '\0')) text.pop_back();
  std::ranges::replace(text, '\n', ' ');
  return text.empty() ? "no reason given" : text;
}

std::string device_name() {
  const GLubyte* name = glGetString(GL_RENDERER);
  return name == nullptr ? "this device" : reinterpret_cast<const char*>(name);
}

struct Shader {
  GLuint id;

  Shader(GLenum type, const ShaderSource& source) : id(glCreateShader(type)) {
    const char* text = source.bytes.data();
    const auto length = static_cast<GLint>(source.bytes.size());
    glShaderSource(id, 1, &text, &length);
    glCompileShader(id);
    GLint compiled = GL_FALSE;
    glGetShaderiv(id, GL_COMPILE_STATUS, &compiled);
    if (compiled) return;
    const std::string log = log_of(id, glGetShaderInfoLog);
    glDeleteShader(id);
    throw Error("the shader " + std::string(source.name) + " does not compile on " + device_name() + " (" +
                log + "): update the driver, or choose another device or engine");
  }
  ~Shader() { glDeleteShader(id); }
  Shader(const Shader&) = delete;
  Shader& operator=(const Shader&) = delete;
};

}  // namespace

Program::Program(const ShaderSource& vertex, const ShaderSource& fragment) {
  const Shader first(GL_VERTEX_SHADER, vertex), second(GL_FRAGMENT_SHADER, fragment);
  id_ = glCreateProgram();
  glAttachShader(id_, first.id);
  glAttachShader(id_, second.id);
  glLinkProgram(id_);
  glDetachShader(id_, first.id);
  glDetachShader(id_, second.id);
  GLint linked = GL_FALSE;
  glGetProgramiv(id_, GL_LINK_STATUS, &linked);
  if (linked) return;
  const std::string log = log_of(id_, glGetProgramInfoLog);
  glDeleteProgram(id_);
  throw Error("the shaders " + std::string(vertex.name) + " and " + std::string(fragment.name) +
              " do not link on " + device_name() + " (" + log +
              "): update the driver, or choose another device or engine");
}

Program::~Program() {
  if (id_ != 0) glDeleteProgram(id_);
}

GLint Program::uniform(const char* name) const {
  const GLint location = glGetUniformLocation(id_, name);
  if (location < 0) throw Error("the shaders do not use a uniform named " + std::string(name));
  return location;
}

}  // namespace sdm::gl
