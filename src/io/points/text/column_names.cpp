#include "io/points/text/column_names.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <array>

namespace sdm::io {
namespace {

/// Three names, each with a second spelling or none. Of the systems, the first with all names counts.
using System = std::array<std::array<std::string_view, 2>, 3>;
constexpr System kPoints[] = {{{{"x"}, {"y"}, {"z"}}},
                              {{{"easting"}, {"northing"}, {"elevation", "height"}}},
                              {{{"points:0"}, {"points:1"}, {"points:2"}}}};  // ParaView
constexpr System kNormals[] = {{{{"nx", "normal_x"}, {"ny", "normal_y"}, {"nz", "normal_z"}}},
                               {{{"normals:0"}, {"normals:1"}, {"normals:2"}}}};

std::string plain(std::string_view name) {
  constexpr std::string_view kAround = " \t\"'";
  name = name.substr(0, name.find_first_of("[("));
  name.remove_prefix(std::min(name.find_first_not_of(kAround), name.size()));
  name = name.substr(0, name.find_last_not_of(kAround) + 1);
  std::string lower(name);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

bool find(const System& system, const std::vector<std::string>& names, std::size_t* columns) {
  for (std::size_t k = 0; k < 3; ++k) {
    const auto matches = [&](const std::string& name) {
      return !name.empty() && std::ranges::count(system[k], std::string_view(name)) > 0;
    };
    const auto first = std::ranges::find_if(names, matches);
    if (first == names.end()) return false;
    columns[k] = static_cast<std::size_t>(first - names.begin());
  }
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = columns[k] + 1; i < names.size(); ++i)
      if (!names[i].empty() && std::ranges::count(system[k], std::string_view(names[i])) > 0)
        throw Error(fmt::format("the column {} is there twice", system[k][0]));
  return true;
}

}  // namespace

std::optional<NamedColumns> named_columns(const std::vector<std::string_view>& names) {
  std::vector<std::string> all(names.size());
  std::ranges::transform(names, all.begin(), plain);
  NamedColumns result;
  const auto in_any = [&](const auto& systems, std::size_t first_role) {
    return std::ranges::any_of(
        systems, [&](const System& system) { return find(system, all, result.columns + first_role); });
  };
  if (!in_any(kPoints, 0)) return std::nullopt;
  result.has_normals = in_any(kNormals, 3);
  return result;
}

}  // namespace sdm::io
