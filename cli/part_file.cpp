#include "part_file.h"

#include "cad_options.h"
#include "map_files.h"
#include "stopwatch.h"
#include "weld.h"

LoadedPart load_part(const PartFile& part, bool vertices) {
  Stopwatch watch;
  Input input = load_input("mesh", part.file, part.transform, {vertices, part.tessellation});
  check_deflection(part.tessellation, {&input});
  if (part.weld) weld(input, *part.weld);
  inspect(input);
  return {std::move(input), watch.lap()};
}

std::vector<std::filesystem::path> files_of_part() {
  std::vector<std::filesystem::path> files{"report.json", "ball.exr", "ray.exr"};
  for (const std::string& file : all_names()) files.emplace_back(file);
  return files;
}
