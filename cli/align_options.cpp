#include "align_options.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <fstream>
#include <string_view>

#include "declared_options.h"
#include "group_tolerances.h"
#include "open_text.h"
#include "option_checks.h"

namespace {

constexpr std::string_view kBox = "box:";

std::optional<sdm::Box> box_of(std::string_view text) {
  std::vector<double> numbers;
  if (!sdm::read_numbers(text.substr(kBox.size()), {}, 6, numbers)) return std::nullopt;
  sdm::Box box;
  for (int k = 0; k < 3; ++k) {
    box.lower[k] = numbers[k];
    box.upper[k] = numbers[k + 3];
    if (!(box.lower[k] <= box.upper[k])) return std::nullopt;
  }
  return box;
}

CLI::Validator checked(const std::string& needed, bool (*accepts)(const std::string&)) {
  return CLI::Validator(
      [needed, accepts](const std::string& text) {
        return accepts(text) ? std::string() : fmt::format("'{}' is not {}", text, needed);
      },
      "");
}

void add_freedom_options(CLI::App& app, AlignCommand& command, CLI::Option* align) {
  CLI::Option* free = add_declared_option(app, sdm::option_of(&sdm::AlignOptions::freedoms), command.freedoms,
                                          {.name = "free", .as = "align_free"})
                          ->needs(align);
  add_declared_option(app, sdm::option_of(&sdm::AlignFreedoms::about), command.freedoms.about,
                      {.name = "about", .as = "align_about"})
      ->needs(free);
}

}  // namespace

void add_align_options(CLI::App& app, AlignCommand& command) {
  CLI::Option* align = app.add_flag(
      "--align", command.on, "First move O1 onto O2, by a rotation and a translation that fit the surfaces");
  app.add_option(
         "--align-from", command.from,
         "Where the alignment starts: none, O1 as it is placed; pca, where the principal axes agree; auto, "
         "as none and, if the fit is poor, also as pca; or a file with a 4x4 matrix, such as alignment.json")
      ->type_name("auto|none|pca|FILE")
      ->needs(align)
      ->check(non_empty())
      ->capture_default_str();
  app.add_option("--align-on", command.region,
                 "Fit O1 to this part of O2: a group, object or material of its file, or a box in its "
                 "coordinates, box:X0,Y0,Z0,X1,Y1,Z1; may be repeated")
      ->check(checked(
          "the name of a group, or box:X0,Y0,Z0,X1,Y1,Z1",
          [](const std::string& text) { return !text.empty() && (!text.starts_with(kBox) || box_of(text)); }))
      ->type_name("GROUP|box:...")
      ->allow_extra_args(false)
      ->needs(align);
  add_freedom_options(app, command, align);
  app.add_option_function<std::string>(
         "--align-321",
         [&command](const std::string& file) {
           command.on = true;
           command.points_321 = file;
         },
         "Move O1 by six of its points and their places on O2, without a fit: a file with a row of two "
         "points for each, three primary, two secondary and one tertiary")
      ->check(non_empty())
      ->type_name("FILE")
      ->excludes(align);
}

sdm::AlignRegion region_of(const AlignCommand& command, const Input& o2) {
  sdm::AlignRegion region;
  for (const std::string& text : command.region) {
    if (text.starts_with(kBox)) {
      region.boxes.push_back(*box_of(text));
      continue;
    }
    region.faces.resize(o2.mesh.triangles.size());
    const sdm::NamedFaces named = sdm::faces_named(o2.names, text);
    if (named.faces.empty()) throw sdm::Error(fmt::format("--align-on: {}", no_group(text, o2)));
    for (const std::uint32_t face : named.faces) region.faces[face] = 1;
  }
  return region;
}

sdm::Transform read_321(const std::string& file) {
  constexpr std::size_t kRows = 6;
  std::ifstream in = open_text(file);
  std::vector<sdm::Vec3> points, places;
  std::string line;
  for (int row = 1; std::getline(in, line) && points.size() <= kRows; ++row) {
    const auto numbers = parse_row(std::string_view(line).substr(0, line.find('#')));
    if (numbers && numbers->empty()) continue;
    if (!numbers || numbers->size() != 6)
      throw sdm::Error(
          fmt::format("{}: line {} is not six numbers, a point on O1 and its place on O2", file, row));
    const auto& n = *numbers;
    points.push_back({n[0], n[1], n[2]});
    places.push_back({n[3], n[4], n[5]});
  }
  if (points.size() != kRows)
    throw sdm::Error(
        fmt::format("{}: a 3-2-1 alignment needs six rows, a point on O1 and its place on O2 each: "
                    "three primary, two secondary and one tertiary",
                    file));
  try {
    return sdm::align_321(points, places);
  } catch (const sdm::Error& error) {
    throw sdm::Error(file + ": " + error.what());
  }
}
