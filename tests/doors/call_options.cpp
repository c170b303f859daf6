// The door of C++ for doors.py: calls with the options of each line, a call and name=value with blanks
// between them, and "--" before the files. Prints a line for each: numbers, or "error " and why not.
#include <sdm/bake.h>
#include <sdm/io.h>
#include <sdm/points.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace {

using Numbers = std::vector<double>;
using Words = std::vector<std::pair<std::string, std::string>>;
using Files = std::vector<std::string>;

/// Sets the options of structs. Throws sdm::Error for a name that none of them has, and for a value that is
/// none.
template <class... Structs>
void set(const Words& given, Structs&... structs) {
  for (const auto& [word, text] : given) {
    bool found = false;
    const auto set_one = [&, &name = word, &value = text]<class Struct>(Struct& options) {
      sdm::for_each_option<Struct>([&](const auto& option) {
        if (option.name != name) return;
        found = true;
        if (!sdm::read_value(option, value, options))
          throw sdm::Error(sdm::refused(sdm::info_of(option), value, sdm::Spelling::field));
      });
    };
    (set_one(structs), ...);
    if (found) continue;
    std::vector<std::string> known;
    for (const sdm::OptionInfo& option : sdm::options_of<Structs...>()) known.push_back(option.name);
    throw sdm::Error(sdm::unknown_name("option", word, known));
  }
  (sdm::check_options(structs), ...);
}

Numbers numbers_of(const sdm::DistanceStatistics& d) {
  return {static_cast<double>(d.texels), d.min, d.max, d.mean, d.rms};
}

Numbers measured(const sdm::Surface& surface, const sdm::Sites& sites, const sdm::Measure& measure) {
  return numbers_of(sdm::statistics(surface, sdm::compute_map(surface, sites, measure)));
}

Numbers by_map(const Files& files, const Words& given) {
  sdm::AtlasOptions atlas;
  sdm::MapOptions map;
  sdm::AlongOptions along;
  set(given, atlas, map, along);
  std::vector<sdm::GivenOption> names;
  for (const auto& [name, value] : given) names.push_back({name, value});
  sdm::check_exclusions(sdm::options_of<sdm::AtlasOptions, sdm::MapOptions, sdm::AlongOptions>(), names,
                        sdm::Spelling::field);
  const bool by_lines = std::ranges::count(names, "along", &sdm::GivenOption::name) > 0;
  const sdm::Measure measure = by_lines ? sdm::Measure(along) : sdm::Measure(map);
  const sdm::Surface surface(sdm::read_mesh(files[0]), atlas);
  const sdm::DistanceMap result = sdm::compute_map(surface, sdm::Sites(sdm::read_mesh(files[1])), measure);
  Numbers numbers{static_cast<double>(result.sign.method)};
  for (const double number : numbers_of(sdm::statistics(surface, result))) numbers.push_back(number);
  return numbers;
}

Numbers by_self(const Files& files, const Words& given) {
  sdm::AtlasOptions atlas;
  sdm::SelfProximityOptions self;
  set(given, atlas, self.exclusion, self);
  const sdm::Surface surface(sdm::read_mesh(files[0]), atlas);
  const sdm::Exclusion exclusion(surface.mesh(), {.rule = self.exclusion});
  return measured(surface, sdm::Sites(surface.mesh()),
                  sdm::SelfOptions{.exclusion = exclusion, .max_distance = self.max_distance});
}

Numbers by_thickness(const Files& files, const Words& given) {
  sdm::AtlasOptions atlas;
  sdm::ThicknessOptions thickness;
  set(given, atlas, thickness);
  const sdm::Surface surface(sdm::read_mesh(files[0]), atlas);
  return measured(surface, sdm::Sites(surface.mesh()), thickness);
}

Numbers by_points(const Files& files, const Words& given) {
  sdm::PointDistancesOptions options;
  sdm::ColorChoice colors;
  set(given, options.map, colors, options.text);
  options.picture.colormap = colors.colormap;
  options.picture.tolerance = colors.tolerance;
  return numbers_of(
      sdm::measure_points(files[0], sdm::Sites(sdm::read_mesh(files[1])), files[0] + ".cpp.ply", options)
          .distance);
}

Numbers by_align(const Files& files, const Words& given) {
  sdm::AlignOptions options;
  set(given, options, options.freedoms);
  const sdm::Alignment found =
      sdm::align(sdm::read_mesh(files[0]), sdm::Sites(sdm::read_mesh(files[1])), options);
  return {static_cast<double>(found.samples), found.after.rms, found.after.trimmed_rms};
}

Numbers by_simplify(const Files& files, const Words& given) {
  sdm::LevelsOptions options;
  set(given, options);
  Numbers numbers;
  for (const sdm::Simplified& level : sdm::simplify_levels(sdm::read_mesh(files[0]), options).levels) {
    numbers.push_back(static_cast<double>(level.mesh.triangles.size()));
    numbers.insert(numbers.end(), {level.deviation.lower, level.deviation.upper});
  }
  return numbers;
}

/// The numbers of texels with samples that have a point, which for one sample each the command counts too.
Numbers by_bake(const Files& files, const Words& given) {
  sdm::BakeRequest request;
  set(given, request);
  const sdm::MatchOptions match = sdm::match_options(request);
  const sdm::AtlasOptions layout = sdm::sample_layout(request);
  const sdm::Mesh low = sdm::read_mesh(files[1]);
  const sdm::BakeAtlas laid =
      request.atlas ? sdm::BakeAtlas{sdm::Surface(low, layout), {}} : sdm::bake_atlas(low, layout);
  const sdm::TexelMatches matches =
      sdm::match_texels(laid.surface, sdm::Sites(sdm::read_mesh(files[0])), match);
  Numbers numbers{static_cast<double>(laid.surface.resolution() / request.side())};
  for (const sdm::MatchKind kind : {sdm::MatchKind::closest, sdm::MatchKind::facing, sdm::MatchKind::ray})
    numbers.push_back(request.samples > 1 ? 0 : static_cast<double>(std::ranges::count(matches.kind, kind)));
  return numbers;
}

Numbers by_bodies(const Files& files, const Words& given) {
  sdm::ProximityOptions options;
  set(given, options);
  std::vector<sdm::Shape> shapes;
  for (const std::string& file : files) shapes.emplace_back(sdm::read_mesh(file));
  sdm::MultiBodyQuery bodies(std::move(shapes), options);
  Numbers numbers;
  for (const sdm::PairSeparation& pair : bodies.separations()) numbers.push_back(pair.separation.value);
  for (const sdm::PairDepth& pair : bodies.penetration_depths())
    numbers.insert(numbers.end(), {pair.penetration_depth.lower, pair.penetration_depth.upper});
  return numbers;
}

using Call = Numbers (*)(const Files&, const Words&);

const std::map<std::string, Call>& calls() {
  static const std::map<std::string, Call> all{
      {"map", by_map},     {"self", by_self},         {"thickness", by_thickness}, {"points", by_points},
      {"align", by_align}, {"simplify", by_simplify}, {"bake", by_bake},           {"bodies", by_bodies}};
  return all;
}

void answer(const std::string& line) {
  std::istringstream words(line);
  std::string call, word;
  words >> call;
  Words given;
  while (words >> word && word != "--") {
    const std::size_t at = word.find('=');
    given.emplace_back(word.substr(0, at), word.substr(at + 1));
  }
  Files files;
  while (words >> word) files.push_back(word);
  std::string text;
  for (const double number : calls().at(call)(files, given)) text.append(sdm::text_of(number)).append(" ");
  std::puts(text.c_str());
}

}  // namespace

int main() try {
  for (std::string line; std::getline(std::cin, line);) try {
      answer(line);
    } catch (const sdm::Error& error) {
      std::printf("error %s\n", error.what());
    }
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
