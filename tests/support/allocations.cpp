#include "support/allocations.h"

#include <dlfcn.h>
#include <oneapi/tbb/detail/_small_object_pool.h>

#include <atomic>
#include <cstdlib>
#include <limits>
#include <new>

namespace {

constexpr std::size_t kNever = std::numeric_limits<std::size_t>::max();

std::atomic<std::size_t> count = 0;                       // of operator new
std::atomic<std::size_t> attempts = 0, failing = kNever;  // these, and tasks of oneTBB

std::atomic<bool> first_tasks = false;

bool fails() {
  return attempts++ == failing;
}

// Null for the one that is to fail.
void* allocate(std::size_t size, std::size_t alignment) {
  ++count;
  if (fails()) return nullptr;
  if (alignment <= __STDCPP_DEFAULT_NEW_ALIGNMENT__) return std::malloc(size);
  void* memory = nullptr;
  return posix_memalign(&memory, alignment, size) == 0 ? memory : nullptr;
}

void* allocate_or_throw(std::size_t size, std::size_t alignment) {
  if (void* memory = allocate(size, alignment)) return memory;
  throw std::bad_alloc();
}

}  // namespace

// The forms for arrays call these.
void* operator new(std::size_t size) {
  return allocate_or_throw(size, 1);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return allocate_or_throw(size, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {  // of std::stable_sort
  return allocate(size, 1);
}
void* operator new(std::size_t size, std::align_val_t alignment, const std::nothrow_t&) noexcept {
  return allocate(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}

// Memory of tasks, which oneTBB does not take from operator new. The program's own definition precedes that
// of the library, which is called by its name there.
namespace tbb::detail::r1 {

void* allocate(d1::small_object_pool*& pool, std::size_t size, const d1::execution_data& data) {
  static const auto of_library =
      reinterpret_cast<void* (*)(d1::small_object_pool*&, std::size_t, const d1::execution_data&)>(dlsym(
          RTLD_NEXT, "_ZN3tbb6detail2r18allocateERPNS0_2d117small_object_poolEmRKNS2_14execution_dataE"));
  if (fails()) throw std::bad_alloc();
  return of_library(pool, size, data);
}

// Of tasks that are not made by another task.
void* allocate(d1::small_object_pool*& pool, std::size_t size) {
  static const auto of_library = reinterpret_cast<void* (*)(d1::small_object_pool*&, std::size_t)>(
      dlsym(RTLD_NEXT, "_ZN3tbb6detail2r18allocateERPNS0_2d117small_object_poolEm"));
  if (first_tasks && fails()) throw std::bad_alloc();
  return of_library(pool, size);
}

}  // namespace tbb::detail::r1

namespace sdm::test {

std::size_t allocations() {
  return count;
}

FailingAllocation::FailingAllocation(std::size_t k, bool& failed, Tasks tasks)
    : number_(attempts + k), failed_(failed) {
  first_tasks = tasks == Tasks::all;
  failing = number_;
}
FailingAllocation::~FailingAllocation() {
  failing = kNever;
  failed_ = attempts > number_;
}

}  // namespace sdm::test
