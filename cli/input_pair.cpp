#include "input_pair.h"

#include <sdm/execution.h>
#include <sdm/version.h>

#include <algorithm>

#include "cad_options.h"
#include "common_options.h"
#include "format.h"
#include "src/core/stopwatch.h"
#include "weld.h"

void add_pair_arguments(CLI::App& app, PairFiles& files, const std::array<std::string, 2>& descriptions) {
  app.add_option("O1", files.o1, descriptions[0])->required();
  app.add_option("O2", files.o2, descriptions[1])->required();
}

void add_pair_transforms(CLI::App& app, PairFiles& files) {
  add_transform_option(app, "--transform-o1", "O1", files.transform_o1);
  add_transform_option(app, "--transform-o2", "O2", files.transform_o2);
}

void add_pair_reading(CLI::App& app, PairFiles& files) {
  add_weld_option(app, files.weld, "both meshes");
  add_deflection_option(app, files.tessellation);
}

InputPair load_pair(const PairFiles& files, const PairReading& reading) {
  sdm::Stopwatch watch;
  InputPair pair;
  const auto load = [&](Input& input, const char* role, const std::string& file, const std::string& transform,
                        bool vertices) {
    input = load_input(role, file, transform, {vertices, files.tessellation});
    if (files.weld) weld(input, *files.weld);
    if (reading.inspects) inspect(input);
  };
  sdm::run_concurrently({[&] { load(pair.o1, "o1", files.o1, files.transform_o1, reading.vertices[0]); },
                         [&] { load(pair.o2, "o2", files.o2, files.transform_o2, reading.vertices[1]); }});
  check_deflection(files.tessellation, {&pair.o1, &pair.o2});
  pair.import_ms = watch.lap();
  return pair;
}

double smaller_size(const InputPair& pair) {
  return std::min(size_of(sdm::bounds(pair.o1.mesh)), size_of(sdm::bounds(pair.o2.mesh)));
}

nlohmann::ordered_json report_on(const InputPair& pair, const std::string& units) {
  nlohmann::ordered_json json;
  json["version"] = sdm::kVersion;
  json["o1"] = to_json(pair.o1);
  json["o2"] = to_json(pair.o2);
  json["units"] = units;
  return json;
}
