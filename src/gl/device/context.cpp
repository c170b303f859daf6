#include "gl/device/context.h"

#include <sdm/error.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <string>

#include "gl/device/egl_displays.h"

namespace sdm {
namespace gl {
namespace {

std::string lower_case(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(), [](unsigned char c) { return std::tolower(c); });
  return result;
}

// Mesa's software renderers, which EGL does not mark on its older platforms.
bool names_software(std::string_view renderer) {
  const std::string name = lower_case(renderer);
  return std::ranges::any_of(std::array{"llvmpipe", "softpipe", "software"},
                             [&](const char* word) { return name.find(word) != std::string::npos; });
}

// Binds OpenGL as the current API of EGL's functions on this thread, for its lifetime.
struct BoundApi {
  const EGLenum former = eglQueryAPI();
  const bool bound = eglBindAPI(EGL_OPENGL_API);
  ~BoundApi() { eglBindAPI(former); }
};

EGLContext create_context(EGLDisplay display) {
  if (display == EGL_NO_DISPLAY) throw Error("no driver");
  if (!eglInitialize(display, nullptr, nullptr)) throw Error("no driver (" + last_egl_error() + ")");
  if (epoxy_egl_version(display) < 15 && !epoxy_has_egl_extension(display, "EGL_KHR_create_context"))
    throw Error("no EGL 1.5");
  if (!epoxy_has_egl_extension(display, "EGL_KHR_surfaceless_context"))
    throw Error("no EGL_KHR_surfaceless_context");
  EGLConfig config = EGL_NO_CONFIG_KHR;
  if (!epoxy_has_egl_extension(display, "EGL_KHR_no_config_context")) {
    constexpr std::array<EGLint, 5> any{EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, 0, EGL_NONE};
    EGLint count = 0;
    if (!eglChooseConfig(display, any.data(), &config, 1, &count) || count == 0)
      throw Error("no configuration for OpenGL");
  }
  const BoundApi api;
  if (!api.bound) throw Error("only OpenGL ES");
  std::array<EGLint, 9> attributes{EGL_CONTEXT_MAJOR_VERSION,
                                   4,
                                   EGL_CONTEXT_MINOR_VERSION,
                                   5,
                                   EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                   EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                   EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY,
                                   EGL_LOSE_CONTEXT_ON_RESET,
                                   EGL_NONE};
  EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes.data());
  if (context == EGL_NO_CONTEXT) {  // some drivers cannot report resets
    attributes[6] = EGL_NONE;
    context = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes.data());
  }
  if (context == EGL_NO_CONTEXT) throw Error("no OpenGL 4.5 (" + last_egl_error() + ")");
  return context;
}

std::string text_of(GLenum name) {
  const GLubyte* text = glGetString(name);
  return text == nullptr ? "" : reinterpret_cast<const char*>(text);
}

std::string listed(const std::vector<Context>& contexts) {
  std::string text;
  for (std::size_t i = 0; i < contexts.size(); ++i)
    text += (i == 0 ? "" : ", ") + std::to_string(i) + " is " + contexts[i].device().name;
  return text;
}

}  // namespace

struct Context::Impl {
  EGLDisplay display;
  EGLContext context;
  GlDevice device{};
  GLint max_image_size = 0, max_texture_buffer_size = 0;

  ~Impl() { eglDestroyContext(display, context); }
};

Context::Context(const DisplayCandidate& candidate)
    : impl_(new Impl{candidate.display, create_context(candidate.display)}) {
  const Current current(*this);
  if (epoxy_gl_version() < 45) throw Error("only OpenGL " + text_of(GL_VERSION));
  impl_->device = {.name = text_of(GL_RENDERER), .driver = text_of(GL_VERSION)};
  impl_->device.software = candidate.software || names_software(impl_->device.name);
  std::array<GLint, 3> sides{};
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &sides[0]);
  glGetIntegerv(GL_MAX_VIEWPORT_DIMS, &sides[1]);
  impl_->max_image_size = *std::ranges::min_element(sides);
  glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &impl_->max_texture_buffer_size);
}

Context::Context(std::string_view wanted) : Context(choose(wanted)) {}
Context::~Context() = default;
Context::Context(Context&&) noexcept = default;
Context& Context::operator=(Context&&) noexcept = default;

std::vector<Context> Context::open(bool only_the_first) {
  std::vector<Context> opened;
  std::string faults;
  for (const DisplayCandidate& candidate : display_candidates()) {
    if (candidate.last_resort && !opened.empty()) break;
    try {
      opened.push_back(Context(candidate));
      if (only_the_first && !opened.back().device().software) break;
    } catch (const Error& error) {
      faults += (faults.empty() ? "" : "; ") + candidate.name + ": " + error.what();
    }
  }
  if (opened.empty())
    throw Error("no device with OpenGL 4.5 was found (" + faults +
                "): install or update the driver of a graphics card, or libgl1-mesa-dri (Debian) for "
                "OpenGL on the processor, or use another engine");
  std::stable_partition(opened.begin(), opened.end(), [](const Context& c) { return !c.device().software; });
  return opened;
}

std::vector<Context> Context::on_all_devices() {
  return open(false);
}

Context Context::choose(std::string_view wanted) {
  std::vector<Context> contexts = open(wanted.empty());
  if (wanted.empty()) return std::move(contexts.front());
  std::size_t index = 0;
  const auto [end, fault] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), index);
  if (end != wanted.data() + wanted.size()) {
    const std::string part = lower_case(wanted);
    index = std::ranges::find_if(contexts,
                                 [&](const Context& context) {
                                   return lower_case(context.device().name).find(part) != std::string::npos;
                                 }) -
            contexts.begin();
  }
  if (fault == std::errc::result_out_of_range || index >= contexts.size())
    throw Error("there is no OpenGL device '" + std::string(wanted) + "': " + listed(contexts) +
                "; choose one by its number or a part of its name");
  return std::move(contexts[index]);
}

const GlDevice& Context::device() const {
  return impl_->device;
}
int Context::max_image_size() const {
  return impl_->max_image_size;
}
int Context::max_texture_buffer_size() const {
  return impl_->max_texture_buffer_size;
}

Context::Current::Current(const Context& context)
    : api_(eglQueryAPI()), own_display_(context.impl_->display) {
  eglBindAPI(EGL_OPENGL_API);  // the next four calls refer to it
  display_ = eglGetCurrentDisplay();
  draw_ = eglGetCurrentSurface(EGL_DRAW);
  read_ = eglGetCurrentSurface(EGL_READ);
  context_ = eglGetCurrentContext();
  if (eglMakeCurrent(own_display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context.impl_->context)) return;
  const std::string error = last_egl_error();
  eglBindAPI(api_);
  throw Error("an OpenGL context cannot be used on this thread (" + error +
              "): it must be current on no other thread, and no other system's context on this one");
}

Context::Current::~Current() {
  if (context_ != EGL_NO_CONTEXT)
    eglMakeCurrent(display_, draw_, read_, context_);
  else
    eglMakeCurrent(own_display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglBindAPI(api_);
}

void Context::check(std::string_view step) const {
  const GLenum reset = glGetGraphicsResetStatus();
  const GLenum error = glGetError();
  if (reset == GL_NO_ERROR && error == GL_NO_ERROR) return;
  // Errors after the first are its consequences. A lost context reports them forever.
  for (int i = 0; i < 8 && glGetError() != GL_NO_ERROR; ++i) continue;

  const std::string where = " while " + std::string(step);
  if (reset != GL_NO_ERROR || error == GL_CONTEXT_LOST)
    throw Error("the OpenGL device " + device().name + " was reset" + where +
                (reset == GL_GUILTY_CONTEXT_RESET     ? ", because of this program"
                 : reset == GL_INNOCENT_CONTEXT_RESET ? ", because of another program"
                                                      : "") +
                ": run again, or choose another device or engine");
  if (error == GL_OUT_OF_MEMORY)
    throw Error("the OpenGL device " + device().name + " has not enough memory" + where +
                ": choose a lower resolution, or another device or engine");
  constexpr std::array names{"GL_INVALID_ENUM",
                             "GL_INVALID_VALUE",
                             "GL_INVALID_OPERATION",
                             "GL_STACK_OVERFLOW",
                             "GL_STACK_UNDERFLOW",
                             "GL_OUT_OF_MEMORY",
                             "GL_INVALID_FRAMEBUFFER_OPERATION"};
  const std::size_t index = error - GL_INVALID_ENUM;
  throw Error("the OpenGL device " + device().name + " reports " +
              (index < names.size() ? names[index] : "error " + std::to_string(error)) + where +
              ": choose another device or engine");
}

}  // namespace gl

std::vector<GlDevice> gl_devices() {
  std::vector<GlDevice> devices;
  for (const gl::Context& context : gl::Context::on_all_devices()) devices.push_back(context.device());
  return devices;
}

}  // namespace sdm
