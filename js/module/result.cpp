#include "module/result.h"

#include <sdm/error.h>

#include <array>
#include <cstdlib>
#include <stdexcept>

namespace sdm::js {
namespace {

constexpr std::string_view kNoMemory = "not enough memory";

// Of a call each: whoever calls the module sets one, perhaps from another thread, to cancel that call only.
std::array<std::atomic<bool>, 256> flags{};
std::size_t obeyed = 0;

}  // namespace

void Result::add_line(std::string_view name, std::string_view kind) {
  names_.append(name).append(" ").append(kind).append("\n");
}

void Result::add_array(std::string_view name, std::string_view kind, std::span<const std::byte> bytes) {
  arrays[count++] = {bytes.data(), static_cast<std::uint32_t>(bytes.size())};
  add_line(name, kind);
}

void fail_with_current_exception(Result& result) noexcept {
  try {
    throw;
  } catch (const Cancelled&) {
    result.fail_with_literal(Result::Error::cancelled, "cancelled");
  } catch (const std::bad_alloc&) {
    result.fail_with_literal(Result::Error::memory, kNoMemory);
  } catch (const std::length_error&) {
    // Of an array that would be larger than the address space of 32 bits.
    result.fail_with_literal(Result::Error::memory, kNoMemory);
  } catch (const std::exception& error) {
    try {
      result.fail(Result::Error::input, error.what());
    } catch (...) {
      result.fail_with_literal(Result::Error::memory, kNoMemory);
    }
  } catch (...) {
    result.fail_with_literal(Result::Error::input, "unknown error");
  }
}

Result* result_without_memory() noexcept {
  static Result result;
  result.fail_with_literal(Result::Error::memory, kNoMemory);
  return &result;
}

const std::atomic<bool>& cancel_flag() noexcept {
  return flags[obeyed];
}

SDM_EXPORT(sdm_free_result) void free_result(Result* result) {
  if (result != result_without_memory()) delete result;
}

/// The address of 256 bytes. The next calls are cancelled once the byte of sdm_obey() is not 0.
SDM_EXPORT(sdm_cancel_flags) void* cancel_flags() {
  static_assert(sizeof(flags) == 256);
  return flags.data();
}
SDM_EXPORT(sdm_obey) void obey(std::uint32_t flag) {
  obeyed = flag % flags.size();
}

/// Memory for an argument; null if there is not enough.
SDM_EXPORT(sdm_allocate) void* allocate(std::uint32_t bytes) {
  return std::malloc(bytes);
}
SDM_EXPORT(sdm_free) void free_argument(void* block) {
  std::free(block);
}

}  // namespace sdm::js
