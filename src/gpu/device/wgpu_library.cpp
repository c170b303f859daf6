#include "gpu/device/wgpu_library.h"

#include <dlfcn.h>
#include <sdm/error.h>

#include <string>

namespace sdm::gpu {
namespace {

constexpr const char* kFile = "libwgpu_native.so";

Wgpu load() {
  void* const library = dlopen(kFile, RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr)
    throw Error(
        "the gpu engine needs " + std::string(kFile) +
        " (wgpu-native), which was not found: the build downloads it to the folder wgpu_native; put it where "
        "libraries are searched for, or use another engine");
  Wgpu all;
#define SDM_WGPU_LOAD(name)                                                         \
  all.name = reinterpret_cast<decltype(&wgpu##name)>(dlsym(library, "wgpu" #name)); \
  if (all.name == nullptr)                                                          \
    throw Error(std::string(kFile) + " is of another version: it lacks the function wgpu" #name);
  SDM_WGPU_FUNCTIONS(SDM_WGPU_LOAD)
#undef SDM_WGPU_LOAD
  return all;
}

}  // namespace

const Wgpu& wgpu() {
  static const Wgpu all = load();
  return all;
}

}  // namespace sdm::gpu
