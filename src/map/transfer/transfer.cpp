#include <sdm/error.h>
#include <sdm/match.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "closest/facing/facing_normals.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "map/transfer/closest_of_texels.h"
#include "map/transfer/fill_texels.h"

namespace sdm {
namespace {

using map::ClosestOfTexels;
using map::TexelState;

std::size_t rows_of(const AttributeArray& array, const Mesh& mesh) {
  switch (array.domain) {
    case AttributeDomain::vertex:
      return mesh.positions.size();
    case AttributeDomain::face:
      return mesh.triangles.size();
    case AttributeDomain::corner:
      return 3 * mesh.triangles.size();
  }
  return 0;
}

const char* name_of_rows(AttributeDomain domain) {
  switch (domain) {
    case AttributeDomain::vertex:
      return "vertices";
    case AttributeDomain::face:
      return "faces";
    case AttributeDomain::corner:
      return "corners of faces";
  }
  return "";
}

void require_fitting(const AttributeArray& array, const Mesh& mesh) {
  if (array.components == 0) throw Error("an array to transfer needs at least one component");
  if (!array.rows.empty()) {
    if (array.domain != AttributeDomain::corner || array.rows.size() != mesh.triangles.size())
      throw Error("rows of an array to transfer must be those of the corners of each face");
    const std::size_t count = array.values.size() / array.components;
    for (const Triangle& of_face : array.rows)
      for (const std::uint32_t row : of_face)
        if (row != kNone && row >= count)
          throw Error("an array to transfer has " + std::to_string(count) +
                      " rows, but a corner refers to row " + std::to_string(row));
    return;
  }
  const std::size_t rows = rows_of(array, mesh);
  if (array.values.size() / array.components != rows || array.values.size() % array.components != 0)
    throw Error("an array of " + std::to_string(array.components) + " components for each of " +
                std::to_string(rows) + " " + name_of_rows(array.domain) + " has " +
                std::to_string(rows * array.components) + " values, not " +
                std::to_string(array.values.size()));
}

/// Reads the values of points of faces.
class Interpolation {
 public:
  Interpolation(const AttributeArray& array, const Mesh& mesh) : array_(array), mesh_(mesh) {}

  /// Sets the components of `values`; N: their number, or 0 where it is not known at compile time.
  template <std::size_t N>
  void at(const SurfacePoint& point, float* values) const {
    const std::size_t components = N == 0 ? array_.components : N;
    if (array_.domain == AttributeDomain::face) {
      std::copy_n(row(point.face, components), components, values);
      return;
    }
    const bool by_corner = array_.domain == AttributeDomain::corner;
    const Triangle& triangle = mesh_.triangles[point.face];
    std::array<const float*, 3> rows;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t number = !by_corner            ? triangle[i]
                                 : array_.rows.empty() ? 3 * std::size_t{point.face} + i
                                                       : array_.rows[point.face][i];
      if (number == kNone) {
        std::fill_n(values, components, std::numeric_limits<float>::quiet_NaN());
        return;
      }
      rows[i] = row(number, components);
    }
    const Vec3& w = point.barycentric;
    for (std::size_t k = 0; k < components; ++k)
      values[k] = static_cast<float>(w[0] * rows[0][k] + w[1] * rows[1][k] + w[2] * rows[2][k]);
  }

 private:
  [[nodiscard]] const float* row(std::size_t i, std::size_t components) const {
    return array_.values.data() + i * components;
  }

  const AttributeArray& array_;
  const Mesh& mesh_;
};

/// A transfer in progress: what texels get.
struct Texels {
  const Surface& surface;
  const Sites& sites;
  std::vector<TexelState> states;
  std::vector<float> values;
};

/// `points_of()` returns a function of a texel with a face, for the texels of one thread, row by row.
template <std::size_t N, class PointsOf>
void read_values(const AttributeArray& array, const PointsOf& points_of, const Progress& progress,
                 Texels& texels) {
  const std::uint32_t resolution = texels.surface.resolution();
  const auto faces = texels.surface.texel_faces();
  const Interpolation interpolation(array, texels.sites.mesh());
  constexpr std::size_t kRowsOfRange = 8;
  parallel_for(texels.states.size() / resolution, kRowsOfRange, progress, "transfer",
               [&](std::size_t begin, std::size_t end) {
                 auto point_of = points_of();
                 for (std::size_t i = begin * resolution; i < end * resolution; ++i) {
                   float* const values = &texels.values[i * array.components];
                   const SurfacePoint point =
                       faces[i] == kNone ? SurfacePoint{} : point_of(static_cast<std::uint32_t>(i));
                   if (point.face == kNone) {
                     texels.states[i] = faces[i] == kNone ? TexelState::free : TexelState::missing;
                     std::fill_n(values, array.components, std::numeric_limits<float>::quiet_NaN());
                   } else {
                     interpolation.at<N>(point, values);
                     const bool finite = std::all_of(values, values + array.components,
                                                     [](float x) { return std::isfinite(x); });
                     texels.states[i] = finite ? TexelState::valued : TexelState::missing;
                   }
                 }
               });
}

template <class PointsOf>
std::vector<float> transfer_from(const Surface& surface, const Sites& sites, const PointsOf& points_of,
                                 const AttributeArray& array, const TransferOptions& options) {
  const std::size_t count = surface.texel_faces().size();
  Texels texels{surface, sites, std::vector<TexelState>(count), std::vector<float>(count * array.components)};
  switch (array.components) {
    case 1:
      read_values<1>(array, points_of, options.progress, texels);
      break;
    case 3:
      read_values<3>(array, points_of, options.progress, texels);
      break;
    case 4:
      read_values<4>(array, points_of, options.progress, texels);
      break;
    default:
      read_values<0>(array, points_of, options.progress, texels);
  }
  if (options.fill)
    map::fill_free_texels(surface.resolution(), texels.states, map::gutter_of_values(surface.gutter()),
                          array.components, texels.values);
  return std::move(texels.values);
}

}  // namespace

std::vector<float> transfer(const Surface& surface, const Sites& sites, const DistanceMap& map,
                            const AttributeArray& array, const TransferOptions& options) try {
  require_fitting(array, sites.mesh());
  if (map.distance.size() != surface.map_faces().size() || map.resolution != surface.resolution())
    throw Error("the map belongs to another surface: its number of texels differs");
  const std::vector<Vec3> normals =
      map.measured.kind == DistanceKind::facing
          ? facing::facing_normals(surface, map.measured.facing.value_or(90)).normals
          : std::vector<Vec3>();
  const auto points_of = [&] {
    return [points = ClosestOfTexels(surface, sites, map, normals)](std::uint32_t texel) mutable {
      return points.at(texel);
    };
  };
  return transfer_from(surface, sites, points_of, array, options);
} catch (const std::bad_alloc&) {
  throw out_of_memory("the values of a transfer");
}

std::vector<float> transfer(const Surface& surface, const Sites& sites, const TexelMatches& matches,
                            const AttributeArray& array, const TransferOptions& options) try {
  require_fitting(array, sites.mesh());
  require_matches(surface, sites, matches);
  const auto points_of = [&] { return [&](std::uint32_t texel) { return matches.point(texel); }; };
  return transfer_from(surface, sites, points_of, array, options);
} catch (const std::bad_alloc&) {
  throw out_of_memory("the values of a transfer");
}

}  // namespace sdm
