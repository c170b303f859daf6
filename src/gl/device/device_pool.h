// The open devices of a process.
#pragma once

#include <sdm/error.h>

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "core/stopwatch.h"
#include "gl/device/context.h"

namespace sdm::gl {

/// Devices by requested name. One map is drawn at a time. To be never destroyed: at process exit, drivers may
/// be gone before anything could be destroyed. `Device` is made from a name and has a context().
template <class Device>
class DevicePool {
 public:
  /// Calls use(device, ms) for the requested device, with its context current; ms is the time spent on
  /// opening it.
  template <class Use>
  auto with(const std::string& wanted, Use use) {
    const std::lock_guard lock(drawing_);
    const Alone alone;
    Stopwatch watch;
    try {
      std::unique_ptr<Device>& device = open_[wanted];
      if (!device) device = std::make_unique<Device>(wanted);
      const Context::Current current(device->context());
      return use(*device, watch.lap());
    } catch (const Cancelled&) {
      throw;
    } catch (const Error&) {
      open_.erase(wanted);  // it may be lost: the next map opens it anew
      throw;
    }
  }

 private:
  std::mutex drawing_;
  std::map<std::string, std::unique_ptr<Device>, std::less<>> open_;
};

}  // namespace sdm::gl
