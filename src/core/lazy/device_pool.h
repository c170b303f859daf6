// The open devices of a process, of an interface to graphics cards.
#pragma once

#include <sdm/error.h>

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "core/parallel.h"
#include "core/stopwatch.h"

namespace sdm {

/// Devices by requested name, used by one thread at a time. To be never destroyed: at process exit, drivers
/// may be gone before anything could be destroyed. `Device` is made from a name.
template <class Device>
class DevicePool {
 public:
  /// Calls use(device, ms) for the requested device; ms is the time spent on opening it.
  template <class Use>
  auto with(const std::string& wanted, const Use& use) {
    const std::lock_guard lock(using_);
    const Alone alone;
    Stopwatch watch;
    try {
      std::unique_ptr<Device>& device = open_[wanted];
      if (!device) device = std::make_unique<Device>(wanted);
      return use(*device, watch.lap());
    } catch (const Cancelled&) {
      throw;
    } catch (const Error&) {
      open_.erase(wanted);  // it may be lost: the next call opens it anew
      throw;
    }
  }

 private:
  std::mutex using_;
  std::map<std::string, std::unique_ptr<Device>, std::less<>> open_;
};

}  // namespace sdm
