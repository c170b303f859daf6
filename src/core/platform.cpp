#include "core/platform.h"

#include <limits>

#ifdef __wasm__
#include <unistd.h>
#else
#include <random>
#endif

#ifdef __linux__
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <string>
#elif defined(_WIN32)
#ifndef NOMINMAX
#define NOMINMAX
#endif
#include <windows.h>

#include <algorithm>
#endif

namespace sdm::core {

#ifdef __linux__

namespace {

// MemAvailable counts page cache that can be dropped, which _SC_AVPHYS_PAGES does not.
std::size_t machine_memory() {
  std::ifstream meminfo("/proc/meminfo");
  for (std::string key; meminfo >> key;) {
    std::size_t kib = 0;
    if (key == "MemAvailable:" && meminfo >> kib) return kib * 1024;
    meminfo.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  return static_cast<std::size_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

// The limit of the container minus its usage.
std::size_t cgroup_memory() {
  std::size_t limit = 0, used = 0;
  std::ifstream max("/sys/fs/cgroup/memory.max"), usage("/sys/fs/cgroup/memory.current");
  if (max >> limit && usage >> used) return limit > used ? limit - used : 0;
  return std::numeric_limits<std::size_t>::max();
}

// RLIMIT_AS minus the address space in use.
std::size_t address_space() {
  rlimit limit{};
  std::size_t used_pages = 0;
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
    return std::numeric_limits<std::size_t>::max();
  std::ifstream("/proc/self/statm") >> used_pages;
  const std::size_t used = used_pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  return limit.rlim_cur > used ? limit.rlim_cur - used : 0;
}

}  // namespace

std::size_t available_memory() {
  return std::min({machine_memory(), cgroup_memory(), address_space()});
}

std::uint64_t process_number() {
  return static_cast<std::uint64_t>(getpid());
}

#elif defined(__wasm__)

// What the memory of the module may still grow by. Free blocks within it are not counted.
std::size_t available_memory() {
  return std::numeric_limits<std::size_t>::max() - (__builtin_wasm_memory_size(0) << 16);
}

std::uint64_t process_number() {
  return 0;  // there are no other processes
}

#elif defined(_WIN32)

// What is free of the machine's memory, of what the process may commit, and of its address space.
std::size_t available_memory() {
  MEMORYSTATUSEX status{};
  status.dwLength = sizeof status;
  if (!GlobalMemoryStatusEx(&status)) return std::numeric_limits<std::size_t>::max();
  return std::min({status.ullAvailPhys, status.ullAvailPageFile, status.ullAvailVirtual});
}

std::uint64_t process_number() {
  return GetCurrentProcessId();
}

#if defined(__MINGW32__) && !defined(__clang__)
// GCC has thread_local objects in memory that the destructor of one key of POSIX threads frees when the
// thread ends, and destroys the objects by the destructor of another key, which is made when the first object
// is. Destructors run in the order of their keys: the key of the objects must be made before that of the
// memory, which any use makes.
extern "C" int __cxa_thread_atexit(void (*)(void*), void*, void*) noexcept;

namespace {

[[gnu::constructor(101)]] void destroy_objects_before_their_memory() {
  __cxa_thread_atexit([](void*) {}, nullptr, nullptr);
}

}  // namespace
#endif

#else

std::size_t available_memory() {
  return std::numeric_limits<std::size_t>::max();
}

std::uint64_t process_number() {
  static const std::uint64_t number = random_number();
  return number;
}

#endif

std::uint64_t random_number() {
#ifdef __wasm__
  std::uint64_t number = 0;
  static_cast<void>(getentropy(&number, sizeof number));  // does not fail for so few bytes
  return number;
#else
  std::random_device random;
  return std::uint64_t{random()} << 32 | random();
#endif
}

}  // namespace sdm::core
