// The door of C++ for doors.py: maps of a mesh to another one with the options of each line, which are
// name=value with blanks between them. Prints a line for each: numbers of the map, or "error " and why not.
#include <sdm/io.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

namespace {

/// Sets the option if the struct has it. Throws sdm::Error for a value that is none.
template <class Struct>
bool set(Struct& options, const std::string& name, const std::string& value) {
  bool found = false;
  sdm::for_each_option<Struct>([&](const auto& option) {
    if (option.name != name) return;
    found = true;
    if (!sdm::read_value(option, value, options))
      throw sdm::Error(sdm::refused(sdm::info_of(option), value, sdm::Spelling::field));
  });
  return found;
}

void measure(const sdm::Mesh& on, const sdm::Sites& to, std::istringstream given) {
  const auto options = sdm::options_of<sdm::AtlasOptions, sdm::MapOptions, sdm::AlongOptions>();
  sdm::AtlasOptions atlas{.resolution = 64};
  sdm::MapOptions map;
  sdm::AlongOptions along;
  std::vector<sdm::GivenOption> given_options;
  for (std::string word; given >> word;) {
    const std::size_t at = word.find('=');
    const std::string name = word.substr(0, at), value = word.substr(at + 1);
    // Not "||": both measures have max_distance.
    if (int{set(atlas, name, value)} + int{set(map, name, value)} + int{set(along, name, value)} > 0) {
      given_options.push_back({name, value});
      continue;
    }
    std::vector<std::string> known;
    for (const sdm::OptionInfo& option : options) known.push_back(option.name);
    throw sdm::Error(sdm::unknown_name("option", name, known));
  }
  sdm::check_exclusions(options, given_options, sdm::Spelling::field);
  const sdm::Surface surface(on, atlas);
  const bool by_lines = std::ranges::count(given_options, "along", &sdm::GivenOption::name) > 0;
  const sdm::Measure measure = by_lines ? sdm::Measure(along) : sdm::Measure(map);
  const sdm::DistanceMap result = sdm::compute_map(surface, to, measure);
  const sdm::DistanceStatistics numbers = sdm::statistics(surface, result);
  std::printf("%s %zu %.9g %.9g %.9g %.9g\n", sdm::name_of(result.sign.method), numbers.texels, numbers.min,
              numbers.max, numbers.mean, numbers.rms);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 3) return 2;
  const sdm::Mesh on = sdm::read_mesh(argv[1]);
  const sdm::Sites to(sdm::read_mesh(argv[2]));
  for (std::string line; std::getline(std::cin, line);) {
    try {
      measure(on, to, std::istringstream(line));
    } catch (const sdm::Error& error) {
      std::printf("error %s\n", error.what());
    }
  }
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
