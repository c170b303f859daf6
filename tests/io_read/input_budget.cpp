// Replaces operator new, to add up what is allocated.
#include "io_read/input_budget.h"

#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <ctime>
#include <new>

namespace {

// A request beyond it fails, so that a test that exceeds its budget says so rather than exhaust the machine.
constexpr std::size_t kMostBytes = std::size_t{1} << 30;

std::atomic<std::size_t> in_use = 0, peak = 0;

void raise_peak(std::size_t bytes) {
  for (std::size_t known = peak; known < bytes && !peak.compare_exchange_weak(known, bytes);) {
  }
}

void* allocate(std::size_t size) noexcept {
  raise_peak(in_use + size);
  if (size > kMostBytes) return nullptr;
  void* memory = std::malloc(size);
  if (memory != nullptr) in_use += malloc_usable_size(memory);
  return memory;
}

void release(void* memory) noexcept {
  if (memory != nullptr) in_use -= malloc_usable_size(memory);
  std::free(memory);
}

double processor_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

void* operator new(std::size_t size) {
  if (void* memory = allocate(size)) return memory;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {  // of std::stable_sort
  return allocate(size);
}
void operator delete(void* memory) noexcept {
  release(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  release(memory);
}

sdm::test::InputCost sdm::test::cost_of(const std::function<void()>& read) {
  const std::size_t before = in_use;
  peak = before;
  const double start = processor_seconds();
  read();
  return {.bytes = peak - before, .seconds = processor_seconds() - start};
}
