#include "freed_memory.h"

#include <cstdlib>  // IWYU pragma: keep, for __GLIBC__
#include <limits>

#ifdef __GLIBC__
#include <malloc.h>
#endif

void keep_freed_memory() noexcept {
#ifdef __GLIBC__
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  // Arenas of other threads cannot hold large arrays.
  mallopt(M_ARENA_MAX, 1);
#endif
}
