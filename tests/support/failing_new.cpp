// Loaded before the command (LD_PRELOAD): its operator new, which fails from allocation number SDM_FAIL_FIRST
// on, counted from 0, SDM_FAIL_COUNT times. With SDM_FAIL_TELL, the number of all is printed in the end.
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <new>

namespace {

std::size_t number_of(const char* name, std::size_t otherwise) {
  const char* const text = std::getenv(name);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

std::atomic<std::size_t> attempts{0};

bool fails() {
  static const std::size_t first = number_of("SDM_FAIL_FIRST", ~std::size_t{0}),
                           count = number_of("SDM_FAIL_COUNT", 1);
  const std::size_t number = attempts++;
  return number >= first && number - first < count;
}

void* allocate(std::size_t size, std::size_t alignment) {
  if (fails()) return nullptr;
  if (alignment <= __STDCPP_DEFAULT_NEW_ALIGNMENT__) return std::malloc(size);
  void* memory = nullptr;
  return posix_memalign(&memory, alignment, size) == 0 ? memory : nullptr;
}
void* allocate_or_throw(std::size_t size, std::size_t alignment) {
  if (void* memory = allocate(size, alignment)) return memory;
  throw std::bad_alloc();
}

// Its destructor is called in the end.
const struct Teller {
  ~Teller() {
    if (std::getenv("SDM_FAIL_TELL") != nullptr) std::fprintf(stderr, "allocations: %zu\n", attempts.load());
  }
} teller;

}  // namespace

// The forms for arrays call these.
void* operator new(std::size_t size) {
  return allocate_or_throw(size, 1);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return allocate_or_throw(size, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
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
