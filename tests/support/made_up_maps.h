// Maps with chosen distances, for the tests of what reads maps.
#pragma once

#include <sdm/sdm.h>

#include <functional>
#include <vector>

namespace sdm::test {

using Field = std::function<double(const Vec3&)>;

/// A map whose distances are those of `field` where it is not NaN, and whose other values are made up but
/// never repeat by chance. Where it is infinite there is nothing in range, as self maps say it.
[[nodiscard]] DistanceMap map_of(const Surface& surface, const Field& field);

/// The values of the field at the vertices.
[[nodiscard]] std::vector<float> at_vertices(const Mesh& mesh, const Field& field);

}  // namespace sdm::test
