// Loaded before the command (LD_PRELOAD): its operator new, which fails from allocation number SDM_FAIL_FIRST
// on, counted from 0, SDM_FAIL_COUNT times. With SDM_FAIL_TELL, the number of all is printed in the end.
#include <atomic>
#include <cstdio>
#include <cstdlib>

namespace {

std::size_t number_of(const char* name, std::size_t otherwise) {
  const char* const text = std::getenv(name);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

std::atomic<std::size_t> attempts{0};

bool allocation_fails() {
  static const std::size_t first = number_of("SDM_FAIL_FIRST", ~std::size_t{0}),
                           count = number_of("SDM_FAIL_COUNT", 1);
  const std::size_t number = attempts++;
  return number >= first && number - first < count;
}

// Its destructor is called in the end.
const struct Teller {
  ~Teller() {
    if (std::getenv("SDM_FAIL_TELL") != nullptr) std::fprintf(stderr, "allocations: %zu\n", attempts.load());
  }
} teller;

}  // namespace

#include "support/replaced_new.h"  // IWYU pragma: keep, calls allocation_fails()
