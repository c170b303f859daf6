#include "research/figures/reproduce.h"

#include <sdm/gl.h>
#include <sdm/version.h>

#include <algorithm>

#include "core/stopwatch.h"
#include "research/figures/figures.h"

namespace sdm::figures {
namespace {

struct Entry {
  const char* key;
  Figure (*make)(Run&);
};
constexpr Entry kFigures[] = {{"figure1", figure1},
                              {"figure2", figure2},
                              {"figure3", figure3},
                              {"figure4", figure4},
                              {"figure5", figure5},
                              {"figure6", figure6},
                              {"figure7", figure7},
                              {"figure8", figure8},
                              {"polygon_count", polygon_count},
                              {"table_complexity", table_complexity},
                              {"stencil", stencil},
                              {"culling", culling},
                              {"literal_algorithm", literal_algorithm}};

}  // namespace

std::vector<std::string> figure_keys() {
  std::vector<std::string> keys;
  for (const Entry& entry : kFigures) keys.emplace_back(entry.key);
  return keys;
}

Reproduction reproduce(const Options& options) {
  Stopwatch watch;
  Reproduction result{.machine = this_machine(), .quick = options.quick};
  Run run;
  run.quick = options.quick;
  run.mesh = options.mesh;
  run.machine = result.machine;
  if (!result.machine.gl_device.empty()) run.gl = make_gl_engine({});
  run.step = options.step ? options.step : [](std::string_view) {};
  for (const auto& [key, make] : kFigures) {
    if (!options.only.empty() && std::ranges::find(options.only, key) == options.only.end()) continue;
    run.step(key);
    result.figures.push_back(make(run));
  }
  result.seconds = watch.lap() / 1000;
  return result;
}

Json report_json(const Reproduction& reproduction) {
  Json json{{"version", kVersion},
            {"quick", reproduction.quick},
            {"machine", to_json(reproduction.machine)},
            {"run_ms", 1000 * reproduction.seconds}};
  for (const Figure& figure : reproduction.figures) json[figure.key] = figure.json;
  return json;
}

}  // namespace sdm::figures
