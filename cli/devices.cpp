#include "devices.h"

#include <sdm/gl.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "format.h"
#include "src/io/json/report_json.h"

namespace {

nlohmann::ordered_json devices_json(const std::vector<sdm::GlDevice>& devices) {
  auto list = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < devices.size(); ++i) {
    list.push_back({{"index", i}});
    list.back().update(sdm::fields_json(devices[i]));
  }
  return list;
}

void print_table(std::ostream& out, const std::vector<sdm::GlDevice>& devices) {
  std::size_t width = 0;
  for (const sdm::GlDevice& device : devices) width = std::max(width, device.name.size());
  for (std::size_t i = 0; i < devices.size(); ++i)
    out << fmt::format("{}  {:<{}}  {}  {}\n", i, devices[i].name, width,
                       devices[i].software ? "software" : "hardware", devices[i].driver);
}

}  // namespace

void add_devices_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("devices", "List the devices for --engine gl, in order of preference");
  const auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "Print JSON");
  command->footer("Example:\n  sdm devices");
  command->callback([json] {
    const std::vector<sdm::GlDevice> devices = sdm::gl_devices();
    if (*json)
      std::cout << devices_json(devices).dump(2, ' ', false, nlohmann::json::error_handler_t::replace)
                << '\n';
    else
      print_table(std::cout, devices);
  });
}
