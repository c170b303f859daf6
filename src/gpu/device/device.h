// A device that computes, and what a program does with it: buffers, a program of WGSL, and runs of it.
#pragma once

#include <sdm/gpu.h>

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/embedded_file.h"
#include "gpu/device/wgpu_library.h"

namespace sdm::gpu {

/// All devices, those first that are no processors. Throws sdm::Error if there is none.
[[nodiscard]] std::vector<GpuDevice> devices_by_preference();

/// One device. Used by one thread at a time.
class Device {
 public:
  /// Opens the one that GpuOptions::device means. Throws sdm::Error if there is none.
  explicit Device(std::string_view wanted);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  /// As its driver has it.
  [[nodiscard]] const std::string& name() const { return name_; }
  /// The largest buffer that a program can read or write.
  [[nodiscard]] std::size_t most_bytes() const { return most_bytes_; }

  /// Programs can write what is `uniform`, too.
  enum class Use { uniform, read, write, read_back };
  /// Throws sdm::Error if there is not that much memory on the device, or a buffer may not be so large.
  [[nodiscard]] Buffer buffer(std::size_t bytes, Use use, std::string_view purpose);
  /// Writes before whatever runs next.
  void write(const Buffer& buffer, std::span<const std::byte> bytes);

  /// The entry point "main" of a source in WGSL, of parts that follow each other.
  [[nodiscard]] Pipeline pipeline(std::initializer_list<EmbeddedFile> parts);
  struct Binding {
    std::uint32_t number;
    const Buffer* buffer;
  };
  /// Binds buffers in group 0: those that the pipeline uses.
  [[nodiscard]] BindGroup bind(const Pipeline& pipeline, std::span<const Binding> bindings);

  struct Step {
    const Pipeline* pipeline;
    const BindGroup* group;
    std::uint32_t workgroups;
  };
  /// Runs the steps, each of which sees what those before it have written, and waits for them.
  void run(std::span<const Step> steps);
  /// The same, and waits for the first bytes of `result`, which pass through `read_back`.
  void run(std::span<const Step> steps, const Buffer& result, const Buffer& read_back,
           std::span<std::byte> to);

  /// What a driver does that takes a device away, for tests.
  void lose();
  /// What a driver does that permits smaller buffers, for tests.
  void permit(std::size_t bytes) { most_bytes_ = bytes; }

 private:
  struct Faults;

  [[nodiscard]] CommandEncoder record(std::span<const Step> steps);
  void submit(const CommandEncoder& encoder);
  /// Throws sdm::Error if the device is lost or has reported an error.
  void check(std::string_view step) const;

  std::string name_;
  std::unique_ptr<Faults> faults_;  // outlives the device, whose callbacks write there
  std::size_t most_bytes_ = 0;
  bool software_ = false;  // its memory is that of the system
  struct DeviceReleaser {
    void operator()(WGPUDeviceImpl* device) const { wgpu().DeviceRelease(device); }
  };
  std::unique_ptr<WGPUDeviceImpl, DeviceReleaser> device_;
  Queue queue_;
};

}  // namespace sdm::gpu
