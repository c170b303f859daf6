// An OpenGL 4.5 core context without window or display server, by EGL.
#pragma once

#include <epoxy/gl.h>
#include <sdm/raster.h>

#include <memory>
#include <string_view>
#include <vector>

namespace sdm::gl {

/// One context on one device. Not bound to a thread, but current on at most one at a time.
class Context {
 public:
  /// On the device that `wanted` names, as RasterOptions::device does. Throws sdm::Error where there is none.
  explicit Context(std::string_view wanted);
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  [[nodiscard]] const GlDevice& device() const;
  [[nodiscard]] int max_texture_size() const;         ///< texels a side
  [[nodiscard]] int max_texture_buffer_size() const;  ///< texels

  /// Makes the context current on this thread for as long as it lives; then the thread's former one again.
  class Current {
   public:
    explicit Current(const Context& context);
    ~Current();
    Current(const Current&) = delete;
    Current& operator=(const Current&) = delete;

   private:
    void *display_, *draw_, *read_, *context_;  ///< former EGL state of the thread
    void* own_display_;
  };

  /// Throws sdm::Error if the device was reset or lost, ran out of memory, or reports another error since the
  /// last check; `step` says what was being done. Needs the context current. Cheap, but not for inner loops.
  void check(std::string_view step) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sdm::gl
