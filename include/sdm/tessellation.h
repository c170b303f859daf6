/// How the surfaces of a CAD file became triangles.
///
/// Threads: plain values; the functions may be called concurrently.
#pragma once

#include <sdm/api.h>
#include <sdm/names.h>
#include <sdm/options.h>

#include <cstddef>
#include <optional>
#include <string>
#include <tuple>

namespace sdm {

/// What is asked of the triangles of a CAD file.
struct TessellationOptions {
  /// The distance from the triangles to the exact surface that is aimed at, in millimetres. Nothing: 1/2000
  /// of the diagonal of the part's box.
  std::optional<double> deflection{};
  /// Without a deflection: it is at most this, in millimetres, unless the part would have more than
  /// `most_triangles`.
  std::optional<double> at_most{};
  std::size_t most_triangles = 2'000'000;
  double angle =
      0.2;  ///< the angle in radians between the normals of neighbouring triangles that is aimed at
};

template <>
inline constexpr auto kOptions<TessellationOptions> = std::tuple{
    Option{.name = "deflection",
           .member = &TessellationOptions::deflection,
           .text = "The distance in mm that triangles of STEP and IGES may have from the surface, as "
                   "OpenCASCADE keeps it; by default 1/2000 of the diagonal, or a tenth of the tolerance if "
                   "that is less, with up to 2 million triangles. What was measured is reported, as an "
                   "estimate, and verdicts keep so far from the limits.",
           .range = kPositive,
           .value = "D"},
    Option{.name = "angle",
           .member = &TessellationOptions::angle,
           .text = "The angle in radians between the normals of neighbouring triangles of STEP and IGES that "
                   "is aimed at.",
           .range = {.least = 0, .most = 1.5707963267948966, .above = true, .below = true},
           .value = "A"}};

/// The tessellation of a CAD file. Coordinates are in millimetres, whatever the unit of the file.
struct Tessellation {
  std::string format;                ///< "STEP" or "IGES"
  std::string file_unit;             ///< as the file has it, such as "INCH"; empty if it has none
  std::size_t faces = 0;             ///< of all instances of all parts
  std::size_t omitted_faces = 0;     ///< of them, without a triangle, since they could not be tessellated
  double deflection = 0, angle = 0;  ///< that were aimed at
  bool limited = false;              ///< the deflection is above TessellationOptions::at_most
  /// An estimate: the largest distance from a point of the exact surfaces and edges to the triangles, over
  /// points inside of each triangle and of each side on an edge. Other points may be farther.
  double largest_deviation = 0;
  std::size_t measured_points = 0;
};

template <>
inline constexpr std::tuple kFields<Tessellation>{
    Field{"format", &Tessellation::format, "'STEP' or 'IGES'."},
    Field{"file_unit", &Tessellation::file_unit, "The unit of the file; empty if it has none."},
    Field{"faces", &Tessellation::faces, "The faces of all instances of all parts."},
    Field{"omitted_faces", &Tessellation::omitted_faces, "Those that could not be tessellated."},
    Field{"deflection", &Tessellation::deflection, "The deflection that was aimed at."},
    Field{"angle", &Tessellation::angle, "The angle that was aimed at."},
    Field{"largest_deviation", &Tessellation::largest_deviation,
          "An estimate: how far the triangles were found to be from the exact surfaces."},
    Field{"measured_points", &Tessellation::measured_points, "The points that this is from."}};

/// Returns a sentence that distances are to the triangles, by how much these were found to deviate from the
/// surface of `file`, and that verdicts keep so far from the limits.
[[nodiscard]] SDM_API std::string note_on(const Tessellation& tessellation, const std::string& file);

}  // namespace sdm
