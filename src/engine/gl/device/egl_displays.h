// The EGL displays of this machine that may support OpenGL.
#pragma once

#define EGL_NO_X11  // whose headers define words such as None
#include <epoxy/egl.h>

#include <string>
#include <vector>

namespace sdm::gl {

/// An EGL display without a screen. It is shared by the whole process, and so it is never terminated.
struct DisplayCandidate {
  EGLDisplay display;        ///< may not be initialised yet
  std::string name;          ///< for messages
  bool software = false;     ///< as reported by EGL, if known
  bool last_resort = false;  ///< used only if none before it works
};

/// In order of preference: EGL's devices, hardware first; then Mesa's surfaceless platform and the default
/// display, as last resorts. Throws sdm::Error where the OpenGL libraries are not installed.
[[nodiscard]] std::vector<DisplayCandidate> display_candidates();

/// The last error of EGL on this thread, by its name.
[[nodiscard]] std::string last_egl_error();

}  // namespace sdm::gl
