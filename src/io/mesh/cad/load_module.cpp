#include "io/mesh/cad/load_module.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <link.h>
#include <sdm/error.h>
#include <sdm/version.h>

#include <filesystem>
#include <string>

namespace sdm::io::cad {
namespace {

/// What was loaded, or why not.
struct Module {
  ReadCad* read = nullptr;
  std::string fault{};
};

void* open_beside(const std::filesystem::path& folder) {
  for (const char* libraries : {"", SDM_LIBRARIES_BESIDE_PROGRAMS})
    if (const std::filesystem::path file = folder / libraries / kModuleFile; std::filesystem::exists(file))
      return dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  return nullptr;
}

void* open_module() {
  static const int anchor = 0;
  Dl_info here{};
  link_map* object = nullptr;
  if (dladdr1(&anchor, &here, reinterpret_cast<void**>(&object), RTLD_DL_LINKMAP) != 0) {
    // The name of an executable is empty here, and in `here` as it was called.
    const bool executable = object->l_name == nullptr || *object->l_name == '\0';
    std::error_code error;
    const auto file = std::filesystem::canonical(executable ? "/proc/self/exe" : object->l_name, error);
    if (!error)
      if (void* const module = open_beside(file.parent_path())) return module;
  }
  return dlopen(kModuleFile, RTLD_NOW | RTLD_LOCAL);
}

Module open() {
  void* const module = open_module();
  if (module == nullptr)
    return {.fault =
                "this installation of sdm has no module libsdm_cad.so, which reads it through "
                "OpenCASCADE: build sdm with -DSDM_BUILD_CAD=ON (Debian: libocct-data-exchange-dev), "
                "or convert the file to STL or glTF"};
  const auto version = reinterpret_cast<const char* (*)()>(dlsym(module, kVersionSymbol));
  const auto read = reinterpret_cast<ReadCad*>(dlsym(module, kReadSymbol));
  if (version == nullptr || read == nullptr || version() != std::string(kVersion))
    return {.fault = fmt::format("the module libsdm_cad.so that was found is not that of sdm {}", kVersion)};
  return {.read = read};
}

}  // namespace

ReadCad* load_module(const char* format) {
  static const Module module = open();
  if (module.read == nullptr) throw Error(fmt::format("is {}; {}", format, module.fault));
  return module.read;
}

}  // namespace sdm::io::cad
