#include "part_file.h"

#include "cad_options.h"
#include "src/core/stopwatch.h"
#include "weld.h"

LoadedPart load_part(const PartFile& part, bool vertices) {
  sdm::Stopwatch watch;
  Input input = load_input("mesh", part.file, part.transform, {vertices, part.tessellation});
  check_deflection(part.tessellation, {&input});
  if (part.weld) weld(input, *part.weld);
  inspect(input);
  return {std::move(input), watch.lap()};
}

std::vector<std::filesystem::path> planned_files(const MapFiles& files) {
  std::vector<std::filesystem::path> planned{"report.json"};
  for (const std::string& file : names(files)) planned.emplace_back(file);
  return planned;
}
