// What wasi-libc asks its host for, as far as the library uses it: there are no files and no streams.
#include <cstdint>
#include <cstdlib>

#include "runtime/host.h"

// The tag of C++ exceptions, which compiler-rt has elsewhere.
asm(".globl __cpp_exception\n.tagtype __cpp_exception i32\n__cpp_exception:\n");

extern "C" {

std::int32_t __imported_wasi_snapshot_preview1_clock_time_get(std::int32_t, std::int64_t, std::int32_t time) {
  *reinterpret_cast<std::uint64_t*>(time) = static_cast<std::uint64_t>(sdm_host_now() * 1e6);
  return 0;
}

// A trap, as an exception of JavaScript would be caught by C++, which would abort again.
void abort() {
  __builtin_trap();
}

// Threads do not end, so that what is local to them is not destroyed.
int __cxa_thread_atexit(void (*)(void*), void*, void*) {
  return 0;
}

// Of the one name that libc++ asks for: the number of processors.
long sysconf(int) {
  return sdm_host_threads();
}

// The allocator of wasi-libc is for one thread.
void* __real_malloc(std::size_t);
void __real_free(void*);
void* __real_calloc(std::size_t, std::size_t);
void* __real_realloc(void*, std::size_t);
void* __real_aligned_alloc(std::size_t, std::size_t);
int __real_posix_memalign(void**, std::size_t, std::size_t);
}

namespace {

class AllocatorLock {
 public:
  AllocatorLock() {
    int free = 0;
    if (__atomic_compare_exchange_n(&word_, &free, 1, false, __ATOMIC_ACQUIRE, __ATOMIC_RELAXED)) return;
    while (__atomic_exchange_n(&word_, 2, __ATOMIC_ACQUIRE) != 0) {
      __builtin_wasm_memory_atomic_wait32(&word_, 2,
                                          1'000'000);  // see threads.cpp: notifications may be lost
      if (sdm_host_thread_failed()) abort();
    }
  }
  ~AllocatorLock() {
    if (__atomic_exchange_n(&word_, 0, __ATOMIC_RELEASE) == 2) __builtin_wasm_memory_atomic_notify(&word_, 1);
  }

 private:
  static inline int word_ = 0;
};

}  // namespace

extern "C" {

void* __wrap_malloc(std::size_t size) {
  const AllocatorLock lock;
  return __real_malloc(size);
}
void __wrap_free(void* block) {
  const AllocatorLock lock;
  __real_free(block);
}
void* __wrap_calloc(std::size_t count, std::size_t size) {
  const AllocatorLock lock;
  return __real_calloc(count, size);
}
void* __wrap_realloc(void* block, std::size_t size) {
  const AllocatorLock lock;
  return __real_realloc(block, size);
}
void* __wrap_aligned_alloc(std::size_t alignment, std::size_t size) {
  const AllocatorLock lock;
  return __real_aligned_alloc(alignment, size);
}
int __wrap_posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  const AllocatorLock lock;
  return __real_posix_memalign(block, alignment, size);
}
}
