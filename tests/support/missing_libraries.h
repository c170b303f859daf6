// Machines without some libraries, simulated: the dlopen of a program that includes this replaces the
// system's.
#pragma once

#include <dlfcn.h>

#include <functional>
#include <set>
#include <string>

namespace sdm::test {
inline std::set<std::string, std::less<>> missing_libraries;
}

extern "C" void* dlopen(const char* file, int mode) noexcept {
  if (file != nullptr && sdm::test::missing_libraries.contains(file)) return nullptr;
  static const auto next = reinterpret_cast<decltype(&dlopen)>(dlsym(RTLD_NEXT, "dlopen"));
  return next(file, mode);
}
