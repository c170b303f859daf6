// Named groups of faces, and tables of their tolerances.
#pragma once

#include <nanobind/nanobind.h>
#include <sdm/mesh_attributes.h>
#include <sdm/sites.h>
#include <sdm/tolerance.h>

#include <span>
#include <vector>

namespace sdm::python {

namespace nb = nanobind;

/// The tolerances of a dict of names, or of a file.
[[nodiscard]] std::vector<GroupTolerance> table_of(nb::handle table, SignMethod sign);
/// Throws sdm::Error for a row whose name no face has.
void check_table(std::span<const GroupTolerance> table, std::span<const FaceNames> names);
/// The kinds of names of `faces` faces. Throws sdm::Error for names of another number of faces.
[[nodiscard]] std::vector<FaceNames> names_of(nb::handle names, std::size_t faces);

struct PyMap;
/// Binds DistanceMap.places() and .check_groups().
void bind_map_groups(nb::class_<PyMap>& map);

}  // namespace sdm::python
