// The field methods of the literature, which run on the processor with the data flow that they were published
// with, and proximity from a field, as volumetric methods determine it.
#pragma once

#include <sdm/mesh.h>
#include <sdm/proximity_query.h>
#include <sdm/volume.h>

#include <limits>
#include <optional>
#include <span>
#include <string_view>

namespace sdm::fields {

/// How the distances of a field are computed.
enum class Method {
  best,         ///< sdm::compute_field
  reference,    ///< the reference engine: each point by itself, in double precision; the oracle
  brute_force,  ///< HCK99: the distance function of every site, drawn in every slice
  /// SOM04 (DiFi): slices are swept; the largest distance of a slice bounds that of the next, which bounds
  /// the disc in which a site is drawn. Sites that no longer influence a slice are culled from later ones.
  difi,
  /// SGGM06: as DiFi, but a site is drawn as the polygon in which its region of influence intersects the
  /// slice, with a distance vector that is linear over the polygon.
  linear_factorization,
  /// Mauch 2003, Sigg et al. 2003: the polyhedron that contains a site's region within the maximum distance
  /// is scan converted, site by site. Requires a maximum distance.
  csc,
};

struct MethodInfo {
  Method method;
  std::string_view name;  ///< as on the command line: "best", "linear_factorization", ...
  /// Upper bound on the error of a distance, rounding to float included, as a fraction of the diagonal of the
  /// bounding box of O2 and the grid.
  double relative_error;
  bool needs_max_distance;
};

/// All methods, best first.
[[nodiscard]] std::span<const MethodInfo> methods();
/// The entry of a method. Throws sdm::Error if there is none.
[[nodiscard]] const MethodInfo& info(Method method);

struct Options {
  Method method = Method::best;
  SignMethod sign = SignMethod::automatic;
  double max_distance = std::numeric_limits<double>::infinity();  ///< as FieldOptions::max_distance
  bool sites = false;                                             ///< also store the closest sites
  /// brute_force: distance functions of edges and vertices are drawn as meshes, as HCK99 and HZLM01 did,
  /// whose distances exceed the true ones by at most this, in units of the mesh, and are never less. The
  /// field is then unsigned, and points from the maximum distance less this on may have no value. 0: they are
  /// evaluated at each point.
  double tessellation = 0;
  Progress progress{};
};

/// What drawing a field cost; 0 for best and reference. A pair is a site and a slice. Counts do not depend on
/// the number of threads.
struct Work {
  double sign_milliseconds = 0;    ///< of the pass that decides signs
  std::uint64_t sites = 0;         ///< whose region of influence has an interior
  std::uint64_t pairs = 0;         ///< sites × slices
  std::uint64_t pairs_culled = 0;  ///< not even clipped: too far from the slice, or culled by an earlier one
  std::uint64_t pairs_empty = 0;   ///< clipped, and nothing remained
  std::uint64_t evaluations = 0;   ///< of a site's distance function at a grid point
};

struct Field : DistanceField {
  Method method = Method::best;
  FieldReport report{};
  Work work{};
};

/// Computes the field. Every method finds the closest sites at every point of the grid, to within
/// DistanceField::accuracy, which includes the tessellation. Throws as sdm::compute_field does, and for an
/// infinite maximum distance where the method needs one, or a tessellation that is negative, too fine for
/// single precision, with another method than brute_force or with signs; Cancelled. All cores. Cost, for m
/// sites and n points a side: brute_force O(m n³); difi and linear_factorization O(m n) for clipping, and
/// what culling leaves of O(m n³); csc O(m) and the points in the polyhedra.
[[nodiscard]] Field compute_field(const Sites& sites, const Grid& grid, const Options& options = {});

struct ProximityOptions {
  /// O1 is sampled at the corners of the triangles that its faces are divided into, with sides of at most
  /// this length; 0: the smallest spacing of the grid.
  double sample_spacing = 0;
  Progress progress{};
};

/// Proximity of the surface of O1 and O2 from the field of O2. Values are estimates, between bounds that hold
/// for all points of O1's surface, not only for the samples.
struct Proximity {
  /// Between the surfaces: the smallest |value| of a sample; `upper` if none has a value.
  BoundedLength separation;
  /// How far the surface of O1 reaches into O2: the largest −value of a sample, 0 if none is inside. Empty
  /// for an unsigned field.
  std::optional<BoundedLength> depth;
  /// As those methods decide it: the value of a sample is not positive, or for an unsigned field not above
  /// error_bound. `exact` where the bounds imply it: a sample is inside O2, or no point of O1's surface is
  /// inside or on it; otherwise an estimate.
  bool colliding = false;
  Certainty colliding_certainty = Certainty::estimate;
  std::size_t samples = 0;
  std::size_t without_value = 0;  ///< samples outside the grid or beside points beyond the maximum distance
  double covering_radius = 0;     ///< no point of O1's surface is farther from all samples
  /// Of the values, as far as samples have one: interpolation_error, field.accuracy and covering_radius.
  double error_bound = 0;
};

/// Throws sdm::Error as sample_field does, if O1 is unusable (see validate), for a spacing that is negative
/// or NaN, or if there would be more than 10^10 samples; Cancelled. Cost: linear in the samples, all cores.
[[nodiscard]] Proximity proximity(const DistanceField& field, const Mesh& o1,
                                  const ProximityOptions& options = {});

}  // namespace sdm::fields
