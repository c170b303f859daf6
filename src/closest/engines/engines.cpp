// The table of engines.
#include <sdm/error.h>
#include <sdm/gl.h>
#include <sdm/gpu.h>

#include <algorithm>
#include <array>
#include <new>
#include <string>

#include "closest/cpu/cpu_engine.h"
#include "closest/reference/reference_engine.h"
#include "core/memory.h"
#include "gl/gl_engine.h"
#include "gpu/gpu_engine.h"

namespace sdm {
namespace {

struct Row {
  EngineInfo info;
  std::shared_ptr<const Engine> (*make)();
};

template <class T>
std::shared_ptr<const Engine> make() {
  return std::make_shared<const T>();
}

constexpr Row kEngines[] = {
    {cpu::CpuEngine::kInfo, make<cpu::CpuEngine>},
    {reference::ReferenceEngine::kInfo, make<reference::ReferenceEngine>},
    {gl::kInfo, [] { return make_gl_engine({}); }},
    {gpu::kInfo, [] { return make_gpu_engine({}); }},
};

constexpr auto kInfos = [] {
  std::array<EngineInfo, std::size(kEngines)> infos;
  std::ranges::transform(kEngines, infos.begin(), &Row::info);
  return infos;
}();

}  // namespace

std::span<const EngineInfo> engines() {
  return kInfos;
}

std::shared_ptr<const Engine> make_engine(std::string_view name) try {
  const Row* row = std::ranges::find(kEngines, name, [](const Row& r) { return r.info.name; });
  if (row != std::end(kEngines)) return row->make();
  std::string known;
  for (const EngineInfo& info : kInfos) known += (known.empty() ? "" : ", ") + std::string(info.name);
  throw Error("there is no engine '" + std::string(name) + "'; the engines are " + known);
} catch (const std::bad_alloc&) {
  throw out_of_memory("an engine");
}

}  // namespace sdm
