// An OpenGL 4.5 core context created by EGL, without a window or display server.
#pragma once

#include <sdm/gl.h>

#include <memory>
#include <string_view>
#include <vector>

namespace sdm::gl {

struct DisplayCandidate;

/// One context on one device. Not bound to a thread, but current on at most one at a time.
class Context {
 public:
  /// Creates a context on the device given by `wanted`, as in GlOptions::device: a whole number is an index.
  /// Throws sdm::Error if there is no such device.
  explicit Context(std::string_view wanted);
  ~Context();
  Context(Context&&) noexcept;
  Context& operator=(Context&&) noexcept;

  /// Creates one on each device, in the order of gl_devices(). Throws sdm::Error if there is none.
  [[nodiscard]] static std::vector<Context> on_all_devices();

  [[nodiscard]] const GlDevice& device() const;
  [[nodiscard]] int max_image_size() const;           ///< texels per side
  [[nodiscard]] int max_texture_buffer_size() const;  ///< texels

  /// Makes the context current on this thread for its lifetime, then restores the previous one.
  class Current {
   public:
    explicit Current(const Context& context);
    ~Current();
    Current(const Current&) = delete;
    Current& operator=(const Current&) = delete;

   private:
    unsigned api_;  ///< the thread's previous EGL state, as are the next four
    void *display_, *draw_, *read_, *context_;
    void* own_display_;
  };

  /// Throws sdm::Error if the device was reset or lost, ran out of memory, or has reported another error
  /// since the last check; `step` describes the operation, such as "drawing the polygons". Requires a current
  /// context. Cheap, but not for inner loops.
  void check(std::string_view step) const;

 private:
  explicit Context(const DisplayCandidate& candidate);
  static std::vector<Context> open(bool only_the_first);
  static Context choose(std::string_view wanted);

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sdm::gl
