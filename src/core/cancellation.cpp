#include "core/cancellation.h"

#include <sdm/error.h>
#include <sdm/execution.h>

namespace sdm {
namespace core {
namespace {

thread_local CancelToken current;

}  // namespace

CancelToken cancel_token() noexcept {
  return current;
}

CancelBy::CancelBy(CancelToken token) noexcept : outer_(current) {
  current = token;
}
CancelBy::~CancelBy() {
  current = outer_;
}

void poll() {
  const auto set = [](const std::atomic<bool>* flag) {
    return flag != nullptr && flag->load(std::memory_order_relaxed);
  };
  if (set(current.flag) || set(current.progress)) throw Cancelled();
}

}  // namespace core

CancelScope::CancelScope(const std::atomic<bool>& cancelled) noexcept : outer_(current.flag) {
  core::current.flag = &cancelled;
}
CancelScope::~CancelScope() {
  core::current.flag = static_cast<const std::atomic<bool>*>(outer_);
}

}  // namespace sdm
