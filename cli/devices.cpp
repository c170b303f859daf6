#include "devices.h"

#include <fmt/format.h>
#include <sdm/error.h>
#include <sdm/gl.h>
#include <sdm/gpu.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "src/io/json/report_json.h"

namespace {

using Json = nlohmann::ordered_json;

/// The devices of an engine, and why there are none.
struct EngineDevices {
  std::string_view engine;
  Json devices = Json::array();
  std::string fault{};
};

template <class Find>
EngineDevices devices_of(std::string_view engine, const Find& find) {
  EngineDevices all{engine};
  try {
    for (const auto& device : find()) {
      Json json{{"engine", engine}, {"index", all.devices.size()}};
      json.update(sdm::fields_json(device));
      all.devices.push_back(std::move(json));
    }
  } catch (const sdm::Error& error) {
    all.fault = error.what();
  }
  return all;
}

void print_table(std::ostream& out, const Json& devices) {
  std::size_t width = 0;
  const auto text = [](const Json& device, const char* key) { return device[key].get<std::string>(); };
  for (const Json& device : devices) width = std::max(width, text(device, "name").size());
  for (const Json& device : devices)
    out << fmt::format("{:<3}  {}  {:<{}}  {}  {}\n", text(device, "engine"), device["index"].dump(),
                       text(device, "name"), width, device["software"] ? "software" : "hardware",
                       text(device, "driver"));
}

void list_devices(bool json) {
  quiet_vulkan();
  const EngineDevices gl = devices_of("gl", sdm::gl_devices), gpu = devices_of("gpu", sdm::gpu_devices);
  if (gl.devices.empty() && gpu.devices.empty()) throw sdm::Error(gl.fault + "; " + gpu.fault);
  for (const EngineDevices* engine : {&gl, &gpu})
    if (engine->devices.empty()) std::cerr << "sdm: note: " << engine->fault << '\n';
  Json all = gl.devices;
  for (const Json& device : gpu.devices) all.push_back(device);
  if (json)
    std::cout << all.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
  else
    print_table(std::cout, all);
}

}  // namespace

void quiet_vulkan() {
  if (std::getenv("XDG_RUNTIME_DIR") == nullptr) setenv("NODEVICE_SELECT", "1", 0);
}

void add_devices_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "devices", "List the devices for --engine gl and --engine gpu, of each in order of preference");
  const auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "Print JSON");
  command->footer("Example:\n  sdm devices");
  command->callback([json] { list_devices(*json); });
}
