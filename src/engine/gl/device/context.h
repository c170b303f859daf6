// An OpenGL 4.5 core context without window or display server, by EGL.
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
  /// On the device that `wanted` names, as GlOptions::device does: a whole number is an index. Throws
  /// sdm::Error where there is none.
  explicit Context(std::string_view wanted);
  ~Context();
  Context(Context&&) noexcept;
  Context& operator=(Context&&) noexcept;

  /// One on each device, in the order of gl_devices(). Throws sdm::Error where there is none.
  [[nodiscard]] static std::vector<Context> on_all_devices();

  [[nodiscard]] const GlDevice& device() const;
  [[nodiscard]] int max_image_size() const;           ///< texels a side
  [[nodiscard]] int max_texture_buffer_size() const;  ///< texels

  /// Makes the context current on this thread for as long as it lives; then the thread's former one again.
  class Current {
   public:
    explicit Current(const Context& context);
    ~Current();
    Current(const Current&) = delete;
    Current& operator=(const Current&) = delete;

   private:
    unsigned api_;  ///< former EGL state of the thread, and the next four
    void *display_, *draw_, *read_, *context_;
    void* own_display_;
  };

  /// Throws sdm::Error if the device was reset or lost, ran out of memory, or reports another error since the
  /// last check; `step` says what was being done, as "drawing the polygons" does. Needs the context current.
  /// Cheap, but not for inner loops.
  void check(std::string_view step) const;

 private:
  explicit Context(const DisplayCandidate& candidate);
  static std::vector<Context> open(bool only_the_first);
  static Context choose(std::string_view wanted);

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sdm::gl
