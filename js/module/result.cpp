#include "module/result.h"

#include <sdm/error.h>

#include <cstdlib>
#include <new>

namespace sdm::js {

void fail_with_current_exception(Result& result) {
  try {
    throw;
  } catch (const Cancelled&) {
    result.fail(Result::Error::cancelled, "cancelled");
  } catch (const std::bad_alloc&) {
    result.fail(Result::Error::memory, "not enough memory");
  } catch (const std::exception& error) {
    result.fail(Result::Error::input, error.what());
  }
}

SDM_EXPORT(sdm_free_result) void free_result(Result* result) {
  delete result;
}

/// Memory for an argument; null if there is not enough.
SDM_EXPORT(sdm_allocate) void* allocate(std::uint32_t bytes) {
  return std::malloc(bytes);
}
SDM_EXPORT(sdm_free) void free_argument(void* block) {
  std::free(block);
}

}  // namespace sdm::js
