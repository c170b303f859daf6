#include "research/figures/machine.h"

#include <fmt/format.h>
#include <sdm/error.h>
#include <sdm/gl.h>
#include <sys/utsname.h>

#include <cstdlib>
#include <fstream>
#include <thread>

#include "core/parallel.h"

namespace sdm::figures {
namespace {

/// The rest of the first line of a file of /proc that begins with `key`, without the colon and spaces.
std::string entry(const char* file, std::string_view key) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);)
    if (line.starts_with(key)) {
      const std::size_t begin = line.find_first_not_of(" \t:", key.size());
      return begin == std::string::npos ? std::string() : line.substr(begin);
    }
  return {};
}

}  // namespace

std::string Machine::gl_text() const {
  if (gl_device.empty()) return "no OpenGL 4.5 device";
  return gl_software
             ? fmt::format("{}, a software rasteriser on the processor, not a GPU ({})", gl_device, gl_driver)
             : fmt::format("{} ({})", gl_device, gl_driver);
}

Machine this_machine() {
  Machine machine;
  machine.processor = entry("/proc/cpuinfo", "model name");
  if (machine.processor.empty()) machine.processor = "unknown";
  utsname name{};
  if (uname(&name) == 0) machine.system = fmt::format("{} {} {}", name.sysname, name.release, name.machine);
#ifdef __clang__
  machine.compiler = "Clang " __clang_version__;
#else
  machine.compiler = "GCC " __VERSION__;
#endif
  machine.cores = std::thread::hardware_concurrency();
  machine.threads = thread_count();
  machine.memory_gb = std::strtod(entry("/proc/meminfo", "MemTotal").c_str(), nullptr) / (1 << 20);
  try {
    const GlDevice device = gl_device(1024);
    machine.gl_device = device.name;
    machine.gl_driver = device.driver;
    machine.gl_software = device.software;
  } catch (const Error&) {  // figures that need a device say so
  }
  return machine;
}

Json to_json(const Machine& m) {
  Json json{{"processor", m.processor}, {"cores", m.cores},   {"threads", m.threads},
            {"memory_gb", m.memory_gb}, {"system", m.system}, {"compiler", m.compiler}};
  json["opengl"] = m.gl_device.empty()
                       ? Json(nullptr)
                       : Json{{"device", m.gl_device}, {"driver", m.gl_driver}, {"software", m.gl_software}};
  return json;
}

}  // namespace sdm::figures
