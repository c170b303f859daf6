// The meshes of Debian's packages (CGAL's and glmark2's), and the placement of meshes.
#pragma once

#include <sdm/mesh.h>

#include <string>
#include <string_view>
#include <vector>

namespace sdm::test {

/// The path of an installed mesh.
[[nodiscard]] std::string mesh_file(const std::string& name);
/// An installed mesh, placed by the steps of io::parse_placement.
[[nodiscard]] Mesh load(const std::string& name, std::string_view steps = "");

[[nodiscard]] Mesh placed(Mesh mesh, std::string_view steps);
/// The same points, moved by the same steps; `fit` has no meaning for them.
[[nodiscard]] std::vector<Vec3> placed(const std::vector<Vec3>& points, std::string_view steps);

}  // namespace sdm::test
