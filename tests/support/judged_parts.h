// Parts to be judged: good ones, and ones with a defect.
#pragma once

#include <sdm/mesh.h>

#include <string>
#include <utility>
#include <vector>

namespace sdm::test {

/// 20 mechanical and free-form parts of size 1, so that lengths are relative, with their names.
[[nodiscard]] std::vector<std::pair<std::string, Mesh>> judged_parts();

/// Each face in quarters: the same surface by other vertices, up to rounding.
[[nodiscard]] Mesh remeshed(const Mesh& mesh);

/// The part with a vertex that is farther than 1.2 times the limit from it, as CGAL finds: the first that is,
/// if moved outwards by 1.25 times the limit.
[[nodiscard]] Mesh with_defect(const Mesh& part, double limit);

}  // namespace sdm::test
