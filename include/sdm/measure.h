/// Measures: what is measured at the samples of a surface. Besides the closest point (sdm/map.h): along a
/// line, to the same mesh, and the wall thickness; and any of all, of which programs choose while they run.
///
/// Threads: the functions may be called concurrently, also with the same Surface and Sites.
#pragma once

#include <sdm/closest_points.h>
#include <sdm/execution.h>
#include <sdm/map.h>
#include <sdm/mesh.h>
#include <sdm/names.h>
#include <sdm/options.h>
#include <sdm/sites.h>
#include <sdm/surface.h>
#include <sdm/types.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

namespace sdm {

/// A measure: the distance to the nearest point of O2 on the line through the sample, to both
/// sides, among the faces that face the same way as the sample. With m, the normal of the sample's face, and
/// u, the unit vector along the line, these are the faces whose normal n has
///   n·m > 0                   along normals (u = m)
///   (n·u) (m·u) > 0           along a direction: seen along it, both show the same side
/// by more than 1e-12. Along the vertical, the distance of terrain is its change of height; both surfaces
/// must be oriented alike. `distance` is positive where the sample is on the side of the hit face to which n
/// points: outside or, of terrain with upward normals, above; its SignMethod is `side`.
/// `vector` leads to the hit, on the face `site`.
///
/// Normals of O2 are outward if it is closed and orientable; otherwise those of its file, made consistent
/// within each component. Those of O1 are outward if it is closed and orientable, otherwise as its triangles
/// are oriented in its file.
///
/// Distances are exact to 1e-11 of the size of the meshes and the rounding to float, at the texels. They are
/// not 1-Lipschitz: nothing bounds them in between. Owned texels without a hit have no value, and count as
/// without_match, or as beyond_max_distance if there is a hit that is farther. Throws sdm::Error for a
/// direction that is 0 or not finite, for a max_distance that is not positive, or if there is not enough
/// memory; Cancelled. Cost: two rays for each texel, all cores.
struct AlongOptions {
  /// The direction of all lines, of any length. Nothing: the normal of each sample's face, or of each point.
  std::optional<Vec3> direction{};
  /// Greater than 0, in units of the meshes. Texels farther than this have no value (NaN).
  double max_distance = kInfinity;
  Progress progress{};
};

inline constexpr std::array kAlongExcludes{ExcludedOption{"sign", "", "none exact winding side"},
                                           ExcludedOption{"engine", "", "gl gpu reference"},
                                           ExcludedOption{"facing"}};

template <>
inline constexpr auto kOptions<AlongOptions> = std::tuple{
    Option{.name = "along",
           .member = &AlongOptions::direction,
           .text =
               "Measure along a line, the normal of each sample's face or a direction, to both sides: to "
               "the nearest face of O2 that faces the same way. Along 0,0,1: the change of height of "
               "terrain. Positive on the side to which the normal of that face points. Between samples, an "
               "estimate.",
           .value = "normal|X,Y,Z",
           .excludes = kAlongExcludes},
    max_distance_option<AlongOptions>()};

/// Measures along lines from points with normals, of any length: `closest` are the hits, of SiteType::face,
/// with the distance without its sign, which is − where `behind`. `unmatched` are the points without a hit at
/// any distance. Without normals, along a direction, all faces count. A point with a normal of 0, or one at a
/// right angle to the direction, has no hit. Also throws for points that are not finite, and unless there is
/// a normal for each point, or none along a direction. Cost: two rays for each point, all cores.
[[nodiscard]] SDM_API FacingPoints closest_points_along(const Sites& sites, std::span<const Vec3> points,
                                                        std::span<const Vec3> normals,
                                                        const AlongOptions& options);

/// What the distances are, in words; `sample` is what they are measured from, such as "sample's face".
[[nodiscard]] SDM_API MeasuredDistance measured_distance(const AlongOptions& options,
                                                         const std::string& sample = "sample's face");

/// What the thickness at a point of the surface of a part is. With n, the inward normal of the point's face:
enum class ThicknessMethod : std::uint8_t {
  ball,  ///< the diameter of the largest ball in the part that touches there, with its centre along n
  ray,   ///< the length of the ray along n until it leaves the part
};

template <>
inline constexpr std::array kWords<ThicknessMethod>{"ball", "ray"};

/// A measure: the thickness of a solid.
///
/// The ray starts at the texel's surface point and ends at the first face whose outward normal has a product
/// with it above 1e-12: faces next to the point, which it touches or enters, do not end it. The ball that
/// touches at the point p reaches the point q at the radius r = |q − p|² / (2 n·(q − p)), if n·(q − p) > 0;
/// it is stopped at the least r of all points of the closed faces that turn by more than the angle, and of
/// the point where the ray ends, if its face turns by more than 90°. Faces must turn by 0.1° more than the
/// angle, as the normals of parts in single precision are not exact: at 90°, the sides of a plate do not stop
/// the balls near its rim.
///
/// A part of several solids is measured solid by solid: of a shell that bounds a solid, only its own faces
/// and those of cavities stop anything, so that parts which touch or overlap do not shorten each other. A
/// solid that intersects itself is measured as if each of its faces bounded it.
///
/// Values are exact to 1e-11 of the diagonal of the mesh and the rounding to float, at the texels. Nothing
/// bounds them in between: the thickness may jump from face to face. Texels of faces that Sites ignores, and
/// balls that nothing stops, have no value (NaN, kNone), and count as beyond_max_distance. At a vertex, balls
/// have 0 where faces meet at an edge that is sharper than the angle allows.
///
/// `vector` of the map leads from the texel's surface point to the point that stops the ball or the ray, on
/// the face `site`. Of the ball, the vector is shorter than the diameter unless both ends are opposite.
///
/// Surface and Sites must be built from the same mesh and positions. Throws sdm::Error if their numbers of
/// faces differ, unless the mesh is closed and orientable, for an angle out of range, or if there is not
/// enough memory; Cancelled. Cost: a ray and a search in the tree for each sample, all cores.
struct ThicknessOptions {
  ThicknessMethod method = ThicknessMethod::ball;
  /// An angle in degrees, greater than 0 and less than 180: the ball is stopped by faces whose normal turns
  /// from that of the point's face by more than this. Faces that turn less are the neighbourhood of the
  /// point, which would stop any ball at 0.
  double angle = 90;
  Progress progress{};
};

template <>
inline constexpr auto kOptions<ThicknessOptions> = std::tuple{
    Option{.name = "method",
           .member = &ThicknessOptions::method,
           .text = "What the thickness is: of the ball, the diameter of the largest ball in the part that "
                   "touches at the point; of the ray, the length of the inward normal to where it leaves the "
                   "part."},
    Option{.name = "angle",
           .member = &ThicknessOptions::angle,
           .text =
               "Of the ball: only faces whose normal turns by more than this from that of the point's face "
               "stop it; faces that turn less are the neighbourhood of the point.",
           .range = {.least = 0, .most = 180, .above = true, .below = true},
           .unit = "degrees",
           .value = "DEGREES"}};

/// Returns what a thickness with these options is.
[[nodiscard]] SDM_API MeasuredDistance measured_distance(const ThicknessOptions& options);

/// The walls of a solid, by rays from a sample of its surface. An estimate.
struct WallEstimate {
  double thin = 0;    ///< the share of the area, in [0, 1], below which the wall is thinner than asked
  double median = 0;  ///< of those walls; 0 if there are none
  std::size_t samples = 0;
};

/// Estimates where the walls of a solid are thinner than a length, by ThicknessMethod::ray at points that are
/// evenly distributed over its area. Nothing if the mesh is open or cannot be oriented. Throws sdm::Error if
/// there is not enough memory. Cost: linear in the faces, and a ray for each sample, all cores.
[[nodiscard]] SDM_API std::optional<WallEstimate> estimate_walls(const Sites& sites, double thin,
                                                                 std::size_t samples = 4096);

/// Returns the thickness that the walls of a solid are below on at least 1 % of its area, as of
/// estimate_walls(): less may be edges that are sharper than a right angle. Infinite for a mesh that bounds
/// no solid. Errors and cost as of estimate_walls().
[[nodiscard]] SDM_API double thin_walls(const Sites& sites);

/// Returns the texels of least value, the least first, each at least 6 % of the diagonal of the mesh from
/// those before it; at most `count`. Throws sdm::Error if the map belongs to another surface. Cost:
/// O(n log n) in texels.
[[nodiscard]] SDM_API std::vector<std::uint32_t> thinnest_texels(const Surface& surface,
                                                                 const DistanceMap& map,
                                                                 std::size_t count = 10);
/// The same of the largest value.
[[nodiscard]] SDM_API std::vector<std::uint32_t> thickest_texels(const Surface& surface,
                                                                 const DistanceMap& map,
                                                                 std::size_t count = 10);

/// The largest error of a thickness, in units of the mesh: of rounding.
[[nodiscard]] SDM_API double thickness_accuracy(const Mesh& mesh);

/// The neighbourhood of a face along the surface, to which no distances are measured.
struct ExclusionRule {
  /// Exclude the face and this many rings of faces around it, connected by shared vertices; ≥ 1.
  std::uint32_t rings = 1;
  /// If set, replaces `rings`: exclude everything closer than this along the surface at rest; > 0, in units
  /// of the mesh.
  std::optional<double> geodesic{};
};

inline constexpr std::array kGeodesicExcludes{ExcludedOption{"rings"}};

template <>
inline constexpr auto kOptions<ExclusionRule> = std::tuple{
    Option{.name = "rings",
           .member = &ExclusionRule::rings,
           .text = "Each face excludes itself and this many rings of neighbours, which share vertices.",
           .range = {1, 1 << 20},
           .value = "K"},
    Option{.name = "geodesic",
           .member = &ExclusionRule::geodesic,
           .text = "Instead: each face excludes what is closer than this along the surface (conservatively).",
           .range = kPositive,
           .unit = "length",
           .value = "L",
           .excludes = kGeodesicExcludes}};

/// Options of an Exclusion.
struct ExclusionOptions {
  ExclusionRule rule{};
  Progress progress{};
};

/// The faces that each face of a mesh excludes: itself and its neighbourhood. The relation is symmetric. It
/// depends on the mesh at rest only, not on later deformation. It is stored for patches: groups of faces that
/// exclude the same faces.
///
/// With rings, every face is a patch of its own. With a geodesic length L, faces form patches around seeds
/// about L/6 apart, which lie in balls of radius L/4; faces too large for that are patches of their own.
/// Patches P and Q exclude each other if a chain of patches, consecutive ones sharing a vertex, leads from P
/// to Q such that every patch of it is less than L from P in a straight line at rest, and likewise a chain
/// from Q to P. Distances are those of single faces, and of the spheres around the bounding boxes of patches
/// of several faces. No point that is not excluded is therefore nearer than L along the surface at rest: the
/// shortest path to it would run through such a chain. The rule is conservative: it excludes whole patches,
/// and so what is up to about 2 L away in a straight line, besides the length of large faces; on fine meshes,
/// 1.6 L. Where the surface at rest folds back within that, it excludes the other side as well.
class SDM_API Exclusion {
 public:
  /// Throws sdm::Error when the mesh is unusable (see validate), for a rule out of range, with rings if more
  /// than 100 pairs of faces for each face, and more than 100 million, share a vertex, and if there is not
  /// enough memory; Cancelled. Memory: with a geodesic length, whatever it is, up to about 200 numbers per
  /// face of a surface with well-shaped faces, but always as many as faces share a vertex; with rings, the
  /// sizes of all neighbourhoods, equal ones of many faces once. Cost: linear in the sizes of all, most of it
  /// on all cores.
  explicit Exclusion(const Mesh& rest, const ExclusionOptions& options = {});

  /// The number of faces of the mesh.
  [[nodiscard]] std::size_t faces() const { return patch_of_.size(); }
  /// The number of patches.
  [[nodiscard]] std::size_t patches() const { return face_offsets_.size() - 1; }
  /// The patch of a face.
  [[nodiscard]] std::uint32_t patch_of(std::uint32_t face) const { return patch_of_[face]; }
  /// The faces of a patch, in increasing order.
  [[nodiscard]] std::span<const std::uint32_t> faces_of(std::uint32_t patch) const {
    return {patch_faces_.data() + face_offsets_[patch], patch_faces_.data() + face_offsets_[patch + 1]};
  }
  /// The patches whose faces the faces of `patch` exclude, itself among them, in increasing order.
  [[nodiscard]] std::span<const std::uint32_t> excluded_by(std::uint32_t patch) const {
    const std::uint32_t row = row_of(patch);
    return {excluded_.data() + offsets_[row], excluded_.data() + offsets_[row + 1]};
  }
  /// Whether two faces exclude each other. Cost: a binary search.
  [[nodiscard]] bool excludes(std::uint32_t face1, std::uint32_t face2) const;

 private:
  void keep_mutual();
  [[nodiscard]] std::uint32_t row_of(std::uint32_t patch) const {
    return rows_.empty() ? patch : rows_[patch];
  }

  std::vector<std::uint32_t> patch_of_;                    ///< of each face
  std::vector<std::uint32_t> patch_faces_, face_offsets_;  ///< the faces of each patch, and where they start
  std::vector<std::uint32_t> rows_;      ///< of each patch: which of the rows below it has; empty: its own
  std::vector<std::uint32_t> excluded_;  ///< patches, by the row
  std::vector<std::size_t> offsets_;     ///< of each row in excluded_, and an end
};

/// A measure (sdm/measure.h): the distance to the closest point of the faces of the same mesh that the
/// sample's face does not exclude. Distances are unsigned, exact up to double rounding, stored in float. A
/// texel with nothing in range, because every face is excluded or farther than max_distance, has the distance
/// +∞, the vector 0, kNone and SiteType::none, and counts as beyond_max_distance; NaN means that no face owns
/// the texel. At a vertex, faces that Sites ignores do not count; NaN means that there are no others. Within
/// a face the distance is 1-Lipschitz; between faces it may jump, as their exclusions differ: the map is of
/// DistanceKind::self, whose samples do not bound the points between them.
///
/// Surface and Sites must be built from the same mesh and positions, the exclusion from the same mesh at
/// rest. Throws sdm::Error if their numbers of faces differ, for a maximum distance out of range, or if there
/// is not enough memory; Cancelled. Cost: one search per texel that skips what is excluded; all cores.
struct SelfOptions {
  const Exclusion& exclusion;       ///< must outlive the options
  double max_distance = kInfinity;  ///< > 0, in units of the mesh: anything farther is ignored
  Progress progress{};
};

/// Options of a mesh and itself, with the rule in place of the exclusion: of a SelfProximityQuery, and of
/// every door but C++.
struct SelfProximityOptions {
  ExclusionRule exclusion{};
  double max_distance = kInfinity;  ///< > 0, in units of the mesh: anything farther is ignored
  Progress progress{};              ///< of the construction
};

template <>
inline constexpr auto kOptions<SelfProximityOptions> = std::tuple{max_distance_option<SelfProximityOptions>(
    "Samples without a surface within this distance have no value.")};

/// A measure is its options: of the closest point of O2 or, with MapOptions::facing, of the faces that face
/// the same way; along lines; to the rest of the same mesh; of the wall thickness. Of the last two, O2 is the
/// mesh of the surface. DistanceKind says what may be concluded from the samples of each.
using Measure = std::variant<MapOptions, AlongOptions, SelfOptions, ThicknessOptions>;

/// Computes the map of a measure. Errors and cost as of the measure: of MapOptions, those of compute_map() in
/// sdm/map.h.
[[nodiscard]] SDM_API DistanceMap compute_map(const Surface& surface, const Sites& sites,
                                              const Measure& measure);

/// Computes the values of some samples, as compute_samples() in sdm/map.h. Errors as of both. Of
/// measures other than MapOptions, each call costs what they prepare, such as the order of the faces, and
/// linear in texels besides.
SDM_API void compute_samples_of_measure(const Surface& surface, const Sites& sites, const Measure& measure,
                                        const SampleRange& range, DistanceMap& map);

/// Returns the distance at each vertex of `mesh`, O1. Of MapOptions, as in sdm/map.h; of other
/// measures, each face around a vertex has a distance there, and the result is that of least absolute value,
/// of the first such face; NaN for a vertex without a value. Errors as of the measure. Cost: a search for
/// each corner of a face, at a vertex once for faces that measure alike; all cores.
[[nodiscard]] SDM_API std::vector<float> distances_at_vertices(const Mesh& mesh, const Sites& sites,
                                                               const Measure& measure);

}  // namespace sdm
