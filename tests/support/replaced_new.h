// The operators new and delete of a program, included once, after `bool allocation_fails()`: an allocation
// for which that is true fails.
#pragma once

#include <cstdlib>
#include <new>

namespace {

#ifdef _WIN32
void* allocate_aligned(std::size_t size, std::size_t alignment) {
  return _aligned_malloc(size, alignment);
}
void free_aligned(void* memory) {
  _aligned_free(memory);
}
#else
void* allocate_aligned(std::size_t size, std::size_t alignment) {
  void* memory = nullptr;
  return posix_memalign(&memory, alignment, size) == 0 ? memory : nullptr;
}
void free_aligned(void* memory) {
  std::free(memory);
}
#endif

void* allocate(std::size_t size, std::size_t alignment) {
  if (allocation_fails()) return nullptr;
  if (alignment <= __STDCPP_DEFAULT_NEW_ALIGNMENT__) return std::malloc(size);
  return allocate_aligned(size, alignment);
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
  free_aligned(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  free_aligned(memory);
}
