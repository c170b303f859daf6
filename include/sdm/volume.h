/// Distance fields: the distance to O2 at the points of a regular grid.
///
/// Threads: the functions may be called concurrently, also with the same Sites and the same field.
#pragma once

#include <sdm/bounds.h>
#include <sdm/execution.h>
#include <sdm/names.h>
#include <sdm/options.h>
#include <sdm/sites.h>
#include <sdm/types.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <tuple>
#include <vector>

namespace sdm {

/// The points origin + (i spacing[0], j spacing[1], k spacing[2]), 0 ≤ i < dims[0] and so on. Point (i, j, k)
/// has the index i + dims[0] (j + dims[1] k); a slice is the points of one k.
struct Grid {
  Vec3 origin{};
  Vec3 spacing{1, 1, 1};                ///< greater than 0
  std::array<std::uint32_t, 3> dims{};  ///< numbers of points, each from 1 to kMostPoints
  static constexpr std::uint32_t kMostPoints = 1 << 20;

  /// The number of points; does not overflow.
  [[nodiscard]] std::size_t size() const { return std::size_t{dims[0]} * dims[1] * dims[2]; }
  /// The index of a point.
  [[nodiscard]] std::size_t index(std::uint32_t i, std::uint32_t j, std::uint32_t k) const {
    return i + std::size_t{dims[0]} * (j + std::size_t{dims[1]} * k);
  }
  /// The place of a point.
  [[nodiscard]] Vec3 point(std::uint32_t i, std::uint32_t j, std::uint32_t k) const {
    return {origin[0] + i * spacing[0], origin[1] + j * spacing[1], origin[2] + k * spacing[2]};
  }
  friend bool operator==(const Grid&, const Grid&) = default;
};

template <>
inline constexpr std::tuple kFields<Grid>{
    Field{"points", &Grid::dims, "The numbers of points along x, y and z."},
    Field{"origin", &Grid::origin, "The first point."},
    Field{"spacing", &Grid::spacing, "Between points along x, y and z."}};

/// Returns the grid whose first and last points are the corners of the box; along an axis with one point, it
/// is in the middle. Throws sdm::Error for a number of points out of range, or a box that is empty or flat
/// along an axis with several points.
[[nodiscard]] SDM_API Grid make_grid(const Box& bounds, const std::array<std::uint32_t, 3>& dims);
/// Returns the grid of cubic cells that covers the box, centred on it, with the fewest points. Throws
/// sdm::Error as above, and for a spacing that is not positive.
[[nodiscard]] SDM_API Grid make_grid(const Box& bounds, double spacing);

/// Options of compute_field().
struct FieldOptions {
  SignMethod sign = SignMethod::automatic;
  /// Greater than 0, in units of the mesh. Points farther than this have no value (NaN).
  double max_distance = kInfinity;
  bool sites = false;  ///< also store the closest sites
  Progress progress{};
};

template <>
inline constexpr auto kOptions<FieldOptions> = std::tuple{
    max_distance_option<FieldOptions>("Points farther than this have no value."),
    Option{.name = "sign", .member = &FieldOptions::sign, .text = kSignText},
    Option{.name = "sites", .member = &FieldOptions::sites, .text = "Also find the closest sites."}};

/// One value per grid point. Points without a value, farther than the maximum distance, hold NaN, kNone and
/// SiteType::none.
struct DistanceField {
  Grid grid;
  std::vector<float> distance;      ///< negative inside O2 if signed
  std::vector<std::uint32_t> site;  ///< index of the closest site among those of its type; empty unless asked
  std::vector<SiteType> site_type;  ///< empty unless asked for
  double max_distance = kInfinity;  ///< as FieldOptions::max_distance
  /// Upper bound on the error of a distance, rounding to float included: 1e-6 of the diagonal of the box of
  /// O2 and the grid.
  double accuracy = 0;
  Box o2_bounds{};  ///< no point outside of it is inside O2
  SignUsed sign;
  std::size_t beyond_max_distance = 0;  ///< points without a value
};

template <>
inline constexpr std::tuple kFields<DistanceField>{
    Field{"grid", &DistanceField::grid, "Where the points are."},
    Field{"max_distance", &DistanceField::max_distance, "Points farther away have no value."},
    Field{"sign", &DistanceField::sign, "How inside and outside are distinguished, and why."},
    Field{"beyond_max_distance", &DistanceField::beyond_max_distance,
          "The number of points without a value."},
    Field{"accuracy", &DistanceField::accuracy,
          "Upper bound on the error of a distance, in units of the mesh, rounding to float32 included."}};

/// Returns the least and the largest distance of the points with a value; NaN if none has one. Cost: linear.
[[nodiscard]] SDM_API std::array<double, 2> distance_range(const DistanceField& field);

/// Computes the field, whose sites and distances are the closest ones to within DistanceField::accuracy.
/// Throws sdm::Error for a grid out of range, with a coordinate beyond 1e37 or with spacings that vanish by
/// rounding, for a sign method that O2 does not allow, for a maximum distance that is not positive, or if
/// there is not enough memory, which is checked before anything is allocated; Cancelled. All cores. Cost: a
/// search per point, or per point near O2 if there is a maximum distance.
[[nodiscard]] SDM_API DistanceField compute_field(const Sites& sites, const Grid& grid,
                                                  const FieldOptions& options = {});

/// What a field cost.
struct FieldReport {
  double milliseconds = 0;
  std::size_t field_bytes = 0;    ///< of the arrays of the field
  std::size_t working_bytes = 0;  ///< allocated besides; an estimate
};

/// The same, with a report.
[[nodiscard]] SDM_API DistanceField compute_field(const Sites& sites, const Grid& grid,
                                                  const FieldOptions& options, FieldReport& report);

/// The distance at a point between grid points: its value is interpolated linearly along each axis, NaN
/// outside the grid and beside a NaN; its bounds hold because distances are 1-Lipschitz.
struct FieldSample : BoundedNumber {
  /// Nothing is known of the distance.
  FieldSample()
      : BoundedNumber{std::numeric_limits<double>::quiet_NaN(), Certainty::bounded, -kInfinity, kInfinity} {}

  double magnitude =
      0;  ///< ≤ |distance|: beyond the maximum distance of a signed field more than the bounds imply
};

/// |value − distance| ≤ interpolation_error(grid) + field.accuracy, unless signs are estimates
/// (is_estimate()), where bounds hold for either sign. Points outside the grid have bounds from
/// its nearest point and from the box of O2. Throws sdm::Error for a coordinate that is not finite, or a
/// field whose arrays do not fit its grid. Cost: constant per point, all cores.
[[nodiscard]] SDM_API std::vector<FieldSample> sample_field(const DistanceField& field,
                                                            std::span<const Vec3> points);

/// Half the diagonal of a cell. An interpolated distance is a mean of the distances at the corners c of the
/// cell, with weights w, each of which differs from that at the point p by at most |c − p|; and
/// Σ w |c − p| ≤ √(Σ w |c − p|²) = √(Σ h² t (1 − t)), over the axes with spacing h and place t in the cell.
[[nodiscard]] SDM_API double interpolation_error(const Grid& grid);

}  // namespace sdm
