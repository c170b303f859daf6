/// Distance fields: the distance to O2 at the points of a regular grid, by our own method and by those of the
/// literature, which run on the processor with the data flow that they were published with.
///
/// Threads: the functions may be called concurrently, also with the same Sites and the same field.
#pragma once

#include <sdm/api.h>
#include <sdm/mesh.h>
#include <sdm/progress.h>
#include <sdm/proximity_query.h>
#include <sdm/sign.h>
#include <sdm/sites.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
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

/// Returns the grid whose first and last points are the corners of the box; along an axis with one point, it
/// is in the middle. Throws sdm::Error for a number of points out of range, or a box that is empty or flat
/// along an axis with several points.
[[nodiscard]] SDM_API Grid make_grid(const Box& bounds, const std::array<std::uint32_t, 3>& dims);
/// Returns the grid of cubic cells that covers the box, centred on it, with the fewest points. Throws
/// sdm::Error as above, and for a spacing that is not positive.
[[nodiscard]] SDM_API Grid make_grid(const Box& bounds, double spacing);

/// How the distances of a field are computed.
enum class FieldMethod {
  best,         ///< the cpu engine, on blocks of points; near O2 only, if there is a band
  reference,    ///< the reference engine: each point by itself, in double precision; the oracle
  brute_force,  ///< HCK99: the distance function of every site, drawn in every slice
  /// SOM04 (DiFi): slices are swept; the largest distance of a slice bounds that of the next, which bounds
  /// the disc in which a site is drawn. Sites that no longer influence a slice are culled from later ones.
  difi,
  /// SGGM06: as DiFi, but a site is drawn as the polygon in which its region of influence intersects the
  /// slice, with a distance vector that is linear over the polygon.
  linear_factorization,
  /// Mauch 2003, Sigg et al. 2003: the polyhedron that contains a site's region within the band is scan
  /// converted, site by site. Requires a band.
  csc,
};

/// What there is to know about a method.
struct FieldMethodInfo {
  FieldMethod method;
  std::string_view name;  ///< as on the command line: "best", "linear_factorization", ...
  std::string_view summary;
  /// Upper bound on the error of a distance, rounding to float included, as a fraction of the diagonal of the
  /// bounding box of O2 and the grid.
  double relative_error;
  bool needs_band;
};

/// All methods, the default one (best) first.
[[nodiscard]] SDM_API std::span<const FieldMethodInfo> field_methods();
/// Throws sdm::Error for an unknown name.
[[nodiscard]] SDM_API const FieldMethodInfo& field_method(std::string_view name);
/// The entry of field_methods() for a method.
[[nodiscard]] SDM_API const FieldMethodInfo& field_method(FieldMethod method);

/// Options of compute_field().
struct FieldOptions {
  FieldMethod method = FieldMethod::best;
  SignMethod sign = SignMethod::automatic;
  /// Greater than 0, in units of the mesh. Points farther than this have no value (NaN).
  double band = std::numeric_limits<double>::infinity();
  bool sites = false;  ///< also store the closest sites
  /// brute_force: distance functions of edges and vertices are drawn as meshes, as HCK99 and HZLM01 did,
  /// whose distances exceed the true ones by at most this, in units of the mesh, and are never less. The
  /// field is then unsigned, and points from the band less this on may have no value. 0: they are evaluated
  /// at each point.
  double tessellation = 0;
  Progress progress{};
};

/// What a field cost. Counts do not depend on the number of threads, except those of working memory.
struct FieldReport {
  FieldMethod method = FieldMethod::best;
  double milliseconds = 0;  ///< of the whole computation but for the sign, if that is a pass of its own
  double sign_milliseconds =
      0;                        ///< of the pass that decides signs; 0 for best and reference, which need none
  std::size_t field_bytes = 0;  ///< of the arrays of the field
  std::size_t working_bytes = 0;  ///< allocated besides, at the end; an estimate for best and reference

  // Of the methods of the literature; 0 for best and reference. A pair is a site and a slice.
  std::uint64_t sites = 0;         ///< whose region of influence has an interior
  std::uint64_t pairs = 0;         ///< sites × slices
  std::uint64_t pairs_culled = 0;  ///< not even clipped: too far from the slice, or culled by an earlier one
  std::uint64_t pairs_empty = 0;   ///< clipped, and nothing remained
  std::uint64_t evaluations = 0;   ///< of a site's distance function at a grid point
};

/// One value per grid point. Points without a value, farther than the band, hold NaN, kNone and
/// SiteType::none.
struct DistanceField {
  Grid grid;
  std::vector<float> distance;      ///< negative inside O2 if signed
  std::vector<std::uint32_t> site;  ///< index of the closest site among those of its type; empty unless asked
  std::vector<SiteType> site_type;  ///< empty unless asked for
  double band = std::numeric_limits<double>::infinity();
  /// Upper bound on the error of a distance, rounding to float included: FieldMethodInfo::relative_error
  /// times the diagonal of the box of O2 and the grid, and FieldOptions::tessellation.
  double accuracy = 0;
  Box o2_bounds{};  ///< no point outside of it is inside O2
  SignUsed sign;
  std::size_t beyond_band = 0;  ///< points without a value
  FieldReport report;
};

/// Computes the field. Every method finds the closest sites at every point of the grid, to within
/// DistanceField::accuracy. Throws sdm::Error for a grid out of range, with a coordinate beyond 1e37
/// or with spacings that vanish by rounding, for a sign method that O2 does not allow, for a band that is not
/// positive, or infinite where the method needs one, for a tessellation that is negative, too fine for single
/// precision, with another method than brute_force or with signs, or if there is not enough memory, which is
/// checked before anything is allocated; Cancelled. All cores. Cost, for m sites and n points a side: best
/// and reference, a search per point, or per point near O2 if there is a band; brute_force O(m n³); difi and
/// linear_factorization O(m n) for clipping, and what culling leaves of O(m n³); csc O(m) and the points in
/// the polyhedra.
[[nodiscard]] SDM_API DistanceField compute_field(const Sites& sites, const Grid& grid,
                                                  const FieldOptions& options = {});

/// The distance at a point between grid points, interpolated linearly along each axis (an estimate), and
/// bounds that hold because distances are 1-Lipschitz.
struct FieldSample {
  double value = std::numeric_limits<double>::quiet_NaN();  ///< NaN outside the grid, and beside a NaN
  double lower = -std::numeric_limits<double>::infinity();  ///< lower ≤ distance ≤ upper
  double upper = std::numeric_limits<double>::infinity();
  double magnitude = 0;  ///< ≤ |distance|: beyond the band of a signed field more than the two imply
};

/// |value − distance| ≤ interpolation_error(grid) + field.accuracy, unless signs are estimates
/// (SignMethod::winding), where bounds hold for either sign. Points outside the grid have bounds from
/// its nearest point and from the box of O2. Throws sdm::Error for a coordinate that is not finite, or a
/// field whose arrays do not fit its grid. Cost: constant per point, all cores.
[[nodiscard]] SDM_API std::vector<FieldSample> sample_field(const DistanceField& field,
                                                            std::span<const Vec3> points);

/// Half the diagonal of a cell. An interpolated distance is a mean of the distances at the corners c of the
/// cell, with weights w, each of which differs from that at the point p by at most |c − p|; and
/// Σ w |c − p| ≤ √(Σ w |c − p|²) = √(Σ h² t (1 − t)), over the axes with spacing h and place t in the cell.
[[nodiscard]] SDM_API double interpolation_error(const Grid& grid);

/// Options of field_proximity().
struct FieldProximityOptions {
  /// O1 is sampled at the corners of the triangles that its faces are divided into, with sides of at most
  /// this length; 0: the smallest spacing of the grid.
  double sample_spacing = 0;
  Progress progress{};
};

/// Proximity of the surface of O1 and O2 from the field of O2, as volumetric methods determine it: for
/// comparison, since ProximityQuery has exact results. Values are estimates, between bounds that hold for all
/// points of O1's surface, not only for the samples.
struct FieldProximity {
  /// Between the surfaces: the smallest |value| of a sample; `upper` if none has a value.
  BoundedLength separation;
  /// How far the surface of O1 reaches into O2: the largest −value of a sample, 0 if none is inside. Empty
  /// for an unsigned field.
  std::optional<BoundedLength> depth;
  /// As those methods decide it: the value of a sample is not positive, or for an unsigned field not above
  /// error_bound. `exact` where the bounds imply it: a sample is inside O2, or no point of O1's surface is
  /// inside or on it; otherwise an estimate.
  BoundedBool colliding;
  std::size_t samples = 0;
  std::size_t without_value = 0;  ///< samples outside the grid or beside points beyond the band
  double covering_radius = 0;     ///< no point of O1's surface is farther from all samples
  /// Of the values, as far as samples have one: interpolation_error, field.accuracy and covering_radius.
  double error_bound = 0;
};

/// Throws sdm::Error as sample_field does, if O1 is unusable (see validate), for a spacing that is negative
/// or NaN, or if there would be more than 10^10 samples; Cancelled. Cost: linear in the samples, all cores.
[[nodiscard]] SDM_API FieldProximity field_proximity(const DistanceField& field, const Mesh& o1,
                                                     const FieldProximityOptions& options = {});

}  // namespace sdm
