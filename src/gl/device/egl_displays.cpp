#include "gl/device/egl_displays.h"

#include <dlfcn.h>
#include <sdm/error.h>

#include <algorithm>
#include <array>

namespace sdm::gl {
namespace {

// libepoxy loads these libraries on first use, and aborts the process if it cannot. They stay loaded: drivers
// do not expect to be unloaded.
void require_libraries() {
  const auto loads = [](const char* library) { return dlopen(library, RTLD_LAZY | RTLD_LOCAL) != nullptr; };
  if (!loads("libEGL.so.1"))
    throw Error("OpenGL needs the library libEGL.so.1, which cannot be loaded: install libegl1 (Debian)");
  if (!loads("libGL.so.1") && !loads("libOpenGL.so.0"))
    throw Error(
        "OpenGL needs the library libOpenGL.so.0 or libGL.so.1, and neither can be loaded: install "
        "libopengl0 or libgl1 (Debian)");
}

bool has_client_extension(const char* name) {
  return epoxy_has_egl_extension(EGL_NO_DISPLAY, name);
}

std::vector<EGLDeviceEXT> devices() {
  // libepoxy's functions abort if an extension that they need is missing.
  if (!has_client_extension("EGL_EXT_platform_device") || !has_client_extension("EGL_EXT_platform_base") ||
      !(has_client_extension("EGL_EXT_device_base") ||
        (has_client_extension("EGL_EXT_device_enumeration") && has_client_extension("EGL_EXT_device_query"))))
    return {};
  EGLint count = 0;
  if (!eglQueryDevicesEXT(0, nullptr, &count) || count <= 0) return {};
  std::vector<EGLDeviceEXT> result(static_cast<std::size_t>(count));
  if (!eglQueryDevicesEXT(count, result.data(), &count)) return {};
  result.resize(static_cast<std::size_t>(std::max(count, 0)));
  return result;
}

bool is_software(EGLDeviceEXT device) {
  const char* extensions = eglQueryDeviceStringEXT(device, EGL_EXTENSIONS);
  return extensions != nullptr && epoxy_extension_in_string(extensions, "EGL_MESA_device_software");
}

}  // namespace

std::vector<DisplayCandidate> display_candidates() {
  require_libraries();
  std::vector<DisplayCandidate> result;
  const std::vector<EGLDeviceEXT> all = devices();
  for (std::size_t i = 0; i < all.size(); ++i) {
    DisplayCandidate& c = result.emplace_back();
    c.display = eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, all[i], nullptr);
    c.name = "EGL device " + std::to_string(i);
    c.software = is_software(all[i]);
  }
  std::stable_partition(result.begin(), result.end(), [](const DisplayCandidate& c) { return !c.software; });

  const auto add_last_resort = [&](EGLDisplay display, const char* name) {
    DisplayCandidate& c = result.emplace_back();
    c.display = display;
    c.name = name;
    c.last_resort = true;
  };
  if (has_client_extension("EGL_MESA_platform_surfaceless") && has_client_extension("EGL_EXT_platform_base"))
    add_last_resort(eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr),
                    "Mesa's surfaceless platform");
  add_last_resort(eglGetDisplay(EGL_DEFAULT_DISPLAY), "EGL's default display");
  return result;
}

std::string last_egl_error() {
  constexpr std::array names{"EGL_SUCCESS",       "EGL_NOT_INITIALIZED",     "EGL_BAD_ACCESS",
                             "EGL_BAD_ALLOC",     "EGL_BAD_ATTRIBUTE",       "EGL_BAD_CONFIG",
                             "EGL_BAD_CONTEXT",   "EGL_BAD_CURRENT_SURFACE", "EGL_BAD_DISPLAY",
                             "EGL_BAD_MATCH",     "EGL_BAD_NATIVE_PIXMAP",   "EGL_BAD_NATIVE_WINDOW",
                             "EGL_BAD_PARAMETER", "EGL_BAD_SURFACE",         "EGL_CONTEXT_LOST"};
  const EGLint error = eglGetError();
  const auto index = static_cast<std::size_t>(error - EGL_SUCCESS);
  return index < names.size() ? names[index] : "EGL error " + std::to_string(error);
}

}  // namespace sdm::gl
