// The EGL displays of this machine that may support OpenGL.
#pragma once

#define EGL_NO_X11  // its headers define macros such as None
#include <epoxy/egl.h>

#include <string>
#include <vector>

namespace sdm::gl {

/// An EGL display without a screen. Shared by the whole process, so it is never terminated.
struct DisplayCandidate {
  EGLDisplay display;        ///< may not be initialised yet
  std::string name;          ///< for error messages
  bool software = false;     ///< as reported by EGL, if it reports it
  bool last_resort = false;  ///< used only if no earlier one works
};

/// The displays, the preferred ones first: EGL's devices, hardware before software; then, as last resorts,
/// Mesa's surfaceless platform and the default display. Throws sdm::Error if the OpenGL libraries are not
/// installed.
[[nodiscard]] std::vector<DisplayCandidate> display_candidates();

/// The name of EGL's last error on this thread.
[[nodiscard]] std::string last_egl_error();

}  // namespace sdm::gl
