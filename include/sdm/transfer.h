/// Transfer: the values that O2 has at the closest points of O1's texels, such as its colours or
/// temperatures.
///
/// Threads: the functions may be called concurrently, also with the same map.
#pragma once

#include <sdm/api.h>
#include <sdm/map.h>
#include <sdm/match.h>
#include <sdm/names.h>
#include <sdm/options.h>
#include <sdm/progress.h>
#include <sdm/sites.h>
#include <sdm/surface.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <tuple>
#include <vector>

namespace sdm {

/// What an array over a mesh has a row for.
enum class AttributeDomain : std::uint8_t {
  vertex,  ///< each vertex; linear within faces
  face,    ///< each face; constant within it
  corner,  ///< each corner of each face, number 3 · face + corner; linear within faces
};

template <>
inline constexpr std::array kWords<AttributeDomain>{"vertex", "face", "corner"};

/// An array over the vertices, faces or corners of a mesh.
struct AttributeArray {
  std::span<const float> values;  ///< row after row
  std::size_t components = 1;     ///< of a row
  AttributeDomain domain = AttributeDomain::vertex;
  /// The rows of each face's corners, if corners share rows as in MeshAttribute::rows; kNone has the value
  /// NaN. Empty: every corner has its own.
  std::span<const Triangle> rows{};
};

template <>
inline constexpr std::tuple kOptions<AttributeArray>{
    Option{.name = "components",
           .member = &AttributeArray::components,
           .text = "Numbers of each vertex, face or corner.",
           .range = {1, std::numeric_limits<std::uint32_t>::max()}},
    Option{
        .name = "domain",
        .member = &AttributeArray::domain,
        .text =
            "What the values are of: vertices or corners, between which they are interpolated, or faces."}};

/// Options of transfer().
struct TransferOptions {
  /// Whether the texels of no face get values too, so that filtering at the border of a chart does not blend
  /// in a background: beside charts, within 4 to 16 texels by AtlasOptions::gutter, those of the nearest
  /// texel that has one; elsewhere smooth ones.
  bool fill = true;
  Progress progress{};
};

template <>
inline constexpr auto kOptions<TransferOptions> = std::tuple{
    Option{.name = "fill",
           .member = &TransferOptions::fill,
           .text = "Texels of no face get values too, from texels near them, so that filtering at the border "
                   "of a chart does not blend in a background."}};

/// Returns the values of the array, a row for each texel of the map, at the texel's closest point on O2: that
/// of point_on_face() or, for maps along normals and of thickness, the end of the vector. Values are
/// interpolated in double and stored in float. Texels that a face owns but that have no distance hold NaN; so
/// do, unless they are filled, those that no face owns.
///
/// Of a point on an edge or a vertex, the face is any of those around it: values of faces and corners jump
/// there. A value that is not finite makes those of the texels in its faces not finite; from these, no texel
/// is filled.
///
/// Throws sdm::Error if the array does not fit O2, the map is not one from the surface to the sites, or there
/// is not enough memory; Cancelled. Cost: linear in texels, all cores.
[[nodiscard]] SDM_API std::vector<float> transfer(const Surface& surface, const Sites& sites,
                                                  const DistanceMap& map, const AttributeArray& array,
                                                  const TransferOptions& options = {});

/// The same at the points of matches from this surface to these sites; texels without one hold NaN. Also
/// throws if a match is on a face that O2 does not have.
[[nodiscard]] SDM_API std::vector<float> transfer(const Surface& surface, const Sites& sites,
                                                  const TexelMatches& matches, const AttributeArray& array,
                                                  const TransferOptions& options = {});

}  // namespace sdm
