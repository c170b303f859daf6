#include <dlfcn.h>
#include <oneapi/tbb/detail/_small_object_pool.h>

#include <new>

#include "support/allocation_faults.h"

// Memory of tasks, which oneTBB does not take from operator new. The program's own definition precedes that
// of the library, which is called by its name there.
namespace tbb::detail::r1 {

void* allocate(d1::small_object_pool*& pool, std::size_t size, const d1::execution_data& data) {
  static const auto of_library =
      reinterpret_cast<void* (*)(d1::small_object_pool*&, std::size_t, const d1::execution_data&)>(dlsym(
          RTLD_NEXT, "_ZN3tbb6detail2r18allocateERPNS0_2d117small_object_poolEmRKNS2_14execution_dataE"));
  if (sdm::test::allocation_fails()) throw std::bad_alloc();
  return of_library(pool, size, data);
}

// Of tasks that are not made by another task.
void* allocate(d1::small_object_pool*& pool, std::size_t size) {
  static const auto of_library = reinterpret_cast<void* (*)(d1::small_object_pool*&, std::size_t)>(
      dlsym(RTLD_NEXT, "_ZN3tbb6detail2r18allocateERPNS0_2d117small_object_poolEm"));
  if (sdm::test::first_tasks_may_fail() && sdm::test::allocation_fails()) throw std::bad_alloc();
  return of_library(pool, size);
}

}  // namespace tbb::detail::r1
