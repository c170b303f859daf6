// The names of columns and fields that hold coordinates and normals.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace sdm::io {

/// Roles are numbered as x, y, z, nx, ny, nz.
inline constexpr std::size_t kRoles = 6;
inline constexpr std::string_view kRoleNames[kRoles] = {"x", "y", "z", "nx", "ny", "nz"};

struct NamedColumns {
  std::size_t columns[kRoles] = {};  ///< by their roles
  bool has_normals = false;
};

/// Finds x, y and z, and nx, ny and nz if all are there, among the names of columns: in any case, in quotes
/// or not, and without what follows in brackets, such as a unit. Easting, northing and elevation or height
/// stand for x, y and z where those are not named; so do points:0 to points:2, and normals:0 to normals:2 for
/// normals. Returns nothing without x, y and z. Throws sdm::Error if a name that counts is there twice.
[[nodiscard]] std::optional<NamedColumns> named_columns(const std::vector<std::string_view>& names);

}  // namespace sdm::io
