/// Tolerances: the one rule by which everything is judged, and proofs that every distance of a surface is
/// within a tolerance, or that one is not: of all points, not only of samples.
///
/// Threads: the functions may be called concurrently, also with the same map and Sites.
#pragma once

#include <sdm/engine.h>
#include <sdm/execution.h>
#include <sdm/map.h>
#include <sdm/mesh.h>
#include <sdm/mesh_attributes.h>
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
#include <string_view>
#include <tuple>
#include <vector>

namespace sdm {

/// The distances that are accepted: lower ≤ d ≤ upper, in units of the meshes. A limit may be infinite where
/// this is said.
struct Tolerance {
  double lower = 0, upper = 0;

  Tolerance() = default;
  /// −t ≤ d ≤ t; also for unsigned distances.
  Tolerance(double t)
      : lower(-t), upper(t) {}  // NOLINT(google-explicit-constructor): a number is a tolerance
  /// at_least ≤ d ≤ at_most.
  Tolerance(double at_least, double at_most) : lower(at_least), upper(at_most) {}

  /// Whether distances that differ by their sign only are judged differently: unsigned ones cannot be.
  [[nodiscard]] bool needs_sign() const { return lower < 0 && -lower != upper && lower > -kInfinity; }
  friend bool operator==(const Tolerance&, const Tolerance&) = default;
};

/// One number T for −T ≤ d ≤ T, or LO:HI. No limit is infinite.
template <>
struct OptionForm<Tolerance> {
  static constexpr const char* kType = "tolerance";
  static std::string needed() { return "a number of at least 0, or two, LO:HI, the smaller one first"; }
  SDM_API static bool read(std::string_view text, const OptionRange& range, Tolerance& value);
  SDM_API static std::string text(const Tolerance& value);
  static bool allowed(const Tolerance& value, const OptionRange& range) {
    return value.lower <= value.upper && in_range(value.upper - value.lower, range);
  }
};

/// Fractions of the area of a map's texels, in [0, 1]; they add up to 1. All are 0 for a map without texels.
struct ToleranceShares {
  double below = 0;          ///< d < lower, by more than the accuracy of a distance
  double within = 0;         ///< lower ≤ d ≤ upper
  double above = 0;          ///< d > upper, by more than the accuracy
  double without_value = 0;  ///< farther than the maximum distance of the map
};

template <>
inline constexpr std::tuple kFields<ToleranceShares>{
    Field{"below", &ToleranceShares::below, "The fraction with smaller distances."},
    Field{"within", &ToleranceShares::within, "The fraction within the tolerance."},
    Field{"above", &ToleranceShares::above, "The fraction with larger distances."},
    Field{"without_value", &ToleranceShares::without_value, "The fraction without a distance."}};

/// `accuracy`: the error of a distance, as of engine_accuracy(): rounding exceeds no tolerance. Throws
/// sdm::Error if the map belongs to another surface. Cost: linear in texels, all cores.
[[nodiscard]] SDM_API ToleranceShares tolerance_shares(const Surface& surface, const DistanceMap& map,
                                                       const Tolerance& tolerance, double accuracy);

/// What measured distances prove about a tolerance.
enum class Verdict {
  pass,         ///< every point is within the tolerance
  fail,         ///< some sample is not, or has no value
  not_decided,  ///< all samples are, but that does not prove it for every point
  doubtful,     ///< every point is, but there are doubts whether what was measured is what was meant
};

template <>
inline constexpr std::array kWords<Verdict>{"PASS", "FAIL", "NOT DECIDED", "DOUBTFUL"};

/// Why a verdict is what it is.
enum class VerdictReason {
  all_within,           ///< pass: no point can be out of the tolerance
  exceeded,             ///< fail: a sample is out of the tolerance by more than the accuracy
  beyond_max_distance,  ///< fail: a sample has no value, as it is farther than the maximum distance
  without_match,        ///< fail: a sample, or a face, has no value, as O2 has no face that faces as it does
  between_samples,      ///< not decided: the error bound exceeds the margin
  within_rounding,      ///< not decided: a distance is closer to a limit than the accuracy
  guard_band,           ///< not decided: a distance is closer to a limit than the guard band and the accuracy
  estimated_signs,      ///< not decided: with the other sign, which is an estimate, a distance might be out
  unknown_accuracy,     ///< not decided: the accuracy of the distances is unknown
  nothing_measured,     ///< not decided: there are no samples
  thin_walls,           ///< not decided: the closest point may be on the other skin of a wall
  in_doubt,             ///< doubtful: see Doubt
  small_places,         ///< pass: what is out of the tolerance is smaller than PlaceDecision::least
};

template <>
inline constexpr std::array kWords<VerdictReason>{
    "all within",      "exceeded",   "beyond max distance", "without match",    "between samples",
    "within rounding", "guard band", "estimated signs",     "unknown accuracy", "nothing measured",
    "thin walls",      "in doubt",   "small places"};

/// How the uncertainty of a measurement enters the verdict on it.
enum class DecisionRule {
  simple_acceptance,  ///< not at all: the measured distances are compared with the limits
  /// ISO 14253-1: conformity is proven within the limits reduced by the expanded uncertainty, non-conformity
  /// beyond the limits extended by it, and in between neither is.
  iso_14253_1,
};

template <>
inline constexpr std::array kWords<DecisionRule>{"simple acceptance", "ISO 14253-1"};

/// All that a verdict depends on besides the tolerance. Samples are the texels of a map and the vertices of
/// its faces, or the points of a cloud.
struct Evidence {
  std::optional<double> lowest{}, highest{};  ///< of the distances of all samples with a value
  bool complete = true;                       ///< every sample has a value
  bool unmatched = false;        ///< not complete, as O2 has no face that faces as some sample does
  bool estimated_signs = false;  ///< is_estimate(): between samples a distance may have the other sign
  /// Nothing bounds the distances between samples, whose verdict alone is an estimate for the surface: of
  /// maps whose DistanceKind is not `closest`. The error bound is infinite.
  bool samples_only = false;
  double accuracy = 0;  ///< the error of a distance, as of engine_accuracy(); infinite if it has no bound
  /// The guard band: how far the meshes may be from the surfaces that are meant, as triangles are from those
  /// of CAD, and the uncertainty. A verdict keeps so far from the limits, on both sides of them, besides the
  /// accuracy.
  double guard = 0;
  double uncertainty = 0;  ///< the expanded uncertainty (k = 2) of the measurement, a part of `guard`
  /// Upper bound on how much a distance at any point can differ from those of the samples, without that
  /// error, as of SamplingBound::value(); 0 where there is nothing between samples.
  double error_bound = 0;
  bool is_signed = true;  ///< false: no distance is negative, so that a lower limit of 0 or less holds
  /// The thickness that walls of O2 are below on more than a small part of it, as of thin_walls(): samples
  /// do not decide limits that are larger than half of it. Infinite if distances are not to the closest
  /// point.
  double thin_walls = kInfinity;
};

template <>
inline constexpr std::tuple kFields<Evidence>{
    Field{"lowest", &Evidence::lowest, "The smallest distance of the samples."},
    Field{"highest", &Evidence::highest, "The largest one."},
    Field{"complete", &Evidence::complete, "Every sample has a value."},
    Field{"estimated_signs", &Evidence::estimated_signs,
          "Between samples a distance may have the other sign."},
    Field{"accuracy", &Evidence::accuracy, "The error of a distance."},
    Field{"error_bound", &Evidence::error_bound,
          "How much the distance at any point can differ from those of the samples."},
    Field{"signed", &Evidence::is_signed, "Distances can be negative."},
    Field{"unmatched", &Evidence::unmatched, "Some sample has no face of O2 that faces the same way."},
    Field{"samples_only", &Evidence::samples_only, "Nothing bounds the distances between samples."},
    Field{"guard", &Evidence::guard,
          "How far the meshes may be from the surfaces that are meant, and the uncertainty."},
    Field{"uncertainty", &Evidence::uncertainty, "The expanded uncertainty (k = 2) of the measurement."},
    Field{"thin_walls", &Evidence::thin_walls,
          "The thickness that walls of O2 are below on more than a small part of it; infinite if none are."}};

/// The larger one of the limits that are finite; 0 without any.
[[nodiscard]] SDM_API double largest_limit(const Tolerance& tolerance);

/// What some evidence proves about a tolerance.
struct Judgement {
  Verdict verdict = Verdict::pass;
  VerdictReason reason = VerdictReason::all_within;
  DecisionRule decision_rule = DecisionRule::simple_acceptance;  ///< ISO 14253-1 with an uncertainty
  /// All samples have a value, and none is out of the tolerance by more than the accuracy: verdict is not
  /// Verdict::fail.
  bool within = true;
  /// The verdict holds for every point: not of Verdict::not_decided, nor of a failure that depends on the
  /// sign of an estimate, nor of a pass of samples only.
  bool certified = true;
  /// How far `lowest` and `highest` stay from the limits, less the accuracy and the guard band, whatever
  /// their signs if these are estimates. Verdict::pass needs at least the error bound. Nothing if a sample
  /// has no value, if there are no samples, or if the accuracy has no bound.
  std::optional<double> margin{};
  bool nearest_is_lower = false;  ///< the limit that is exceeded most, or approached most closely
  /// If not decided: an error bound that leads to Verdict::pass if no sample of a finer map comes closer to a
  /// limit than half of the present margin. Nothing if no error bound does.
  std::optional<double> deciding_bound{};
};

/// Judges by the rule for all verdicts. The accuracy benefits the part: rounding exceeds no tolerance, and a
/// distance within it has no certain sign. It also counts against a proof: Verdict::pass needs
/// margin ≥ error_bound, or of samples only margin ≥ 0. The guard band counts as the accuracy does. Cost:
/// O(1).
[[nodiscard]] SDM_API Judgement judge(const Evidence& evidence, const Tolerance& tolerance);

/// Whether all distances of a surface are within a tolerance, in units of the mesh.
struct ToleranceVerdict : Judgement {
  Tolerance tolerance{};
  /// The largest |distance| of all samples and all vertices of faces; nothing if one of them has no value.
  std::optional<double> largest{};
  /// Fraction of the area, in [0, 1], of texels whose distance is out of the tolerance by more than the error
  /// of the engine, or that have no value.
  double exceeded_area_fraction = 0;
  ToleranceShares shares{};
};

template <>
inline constexpr std::tuple kFields<ToleranceVerdict>{
    Field{"tolerance", &ToleranceVerdict::tolerance, "The least and the most accepted distance."},
    Field{
        "verdict", &ToleranceVerdict::verdict,
        "'pass': every point of the surface is within the tolerance; 'fail': some point is not; 'not "
        "decided': neither is proven, as a distance is within the accuracy, or Mesh.deviation, of a limit, "
        "or "
        "signs are estimates; 'doubtful': a 'pass', but walls are thinner than twice the tolerance, and the "
        "faces that face the same way do not decide."},
    Field{"reason", &ToleranceVerdict::reason, "Why, in words."},
    Field{"decision_rule", &ToleranceVerdict::decision_rule,
          "'ISO 14253-1' with an uncertainty, otherwise 'simple acceptance'."},
    Field{"exceeded_area_fraction", &ToleranceVerdict::exceeded_area_fraction,
          "An estimate: the fraction of the area that is out of the tolerance, in [0, 1]."},
    Field{"within", &ToleranceVerdict::within, "No point is known to be out of the tolerance."},
    Field{"certified", &ToleranceVerdict::certified,
          "The verdict holds for every point of the surface; a 'pass' without it is an estimate."},
    Field{"margin", &ToleranceVerdict::margin,
          "How far the distances of texels and vertices stay from the limits, less the accuracy and the "
          "deviations of both meshes; negative if they do not. Nothing if one of them has no value, or none "
          "has."},
    Field{"largest", &ToleranceVerdict::largest,
          "The largest absolute distance of all texels and vertices; nothing if one has no value."}};

/// What a map shows of its surface. `vertex_distances`: the distance at each vertex of surface.mesh(), NaN if
/// it has no value. Throws sdm::Error if the map or the distances belong to another surface. Cost: linear in
/// texels and faces.
[[nodiscard]] SDM_API Evidence evidence_of(const Surface& surface, const DistanceMap& map,
                                           std::span<const float> vertex_distances, double error_bound,
                                           double accuracy);

/// judge() of evidence_of() these, and the shares of the area. Throws sdm::Error if the map or the distances
/// belong to another surface, or if the tolerance needs a sign and the map is unsigned. Cost: linear in
/// texels and faces.
[[nodiscard]] SDM_API ToleranceVerdict check_tolerance(const Surface& surface, const DistanceMap& map,
                                                       std::span<const float> vertex_distances,
                                                       double error_bound, double accuracy,
                                                       const Tolerance& tolerance);

/// Returns an upper bound on the error of any distance that the engine computes from points of `on` to `to`,
/// in units of the meshes, including the rounding to float: EngineInfo::relative_error times the diagonal of
/// the bounding box of both meshes. Cost: linear.
[[nodiscard]] SDM_API double engine_accuracy(const EngineInfo& engine, const Mesh& on, const Mesh& to);

/// The tolerance of a group, by its name.
struct GroupTolerance {
  std::string group;
  Tolerance tolerance{};  ///< infinite on a side without a limit
  std::string kind{};     ///< of the name; empty: the first one of which a face has it
};

/// Returns the faces of each row, as faces_named() does, of the kind of the row if it has one. Cost: linear
/// in faces and rows.
[[nodiscard]] SDM_API std::vector<NamedFaces> faces_of_groups(std::span<const FaceNames> names,
                                                              std::span<const GroupTolerance> table);

/// Returns the table with the kinds that its names have on a mesh, so that the rows mean the same for each of
/// its parts. Cost: linear in faces and rows.
[[nodiscard]] SDM_API std::vector<GroupTolerance> with_kinds(std::span<const FaceNames> names,
                                                             std::span<const GroupTolerance> table);

/// What has been proven of a surface and a tolerance.
enum class Proof {
  holds,      ///< every point of the surface is within the tolerance
  fails,      ///< some point is out of it by more than the accuracy, or has nothing to be measured to
  undecided,  ///< neither
};

/// A point of the surface, and what is known of its distance.
struct ToleranceWitness {
  Vec3 point{}, closest{};                           ///< on the surface, and the point of O2 closest to it
  std::uint32_t face = kNone, closest_face = kNone;  ///< that contain these
  double distance = 0;                               ///< |closest − point|, negative inside O2
};

template <>
inline constexpr std::tuple kFields<ToleranceWitness>{
    Field{"distance", &ToleranceWitness::distance, "Its distance, negative inside O2."},
    Field{"point", &ToleranceWitness::point, "Where it is."},
    Field{"closest", &ToleranceWitness::closest, "The point of O2 closest to it."},
    Field{"face", &ToleranceWitness::face, "The face of O1 that contains it."},
    Field{"closest_face", &ToleranceWitness::closest_face,
          "The face of O2 that contains the closest point."}};

/// The answer of prove_tolerance().
struct ToleranceProof {
  Proof proof = Proof::undecided;
  /// A point out of the tolerance: of Proof::fails, unless the only reason is that faces have no match; if
  /// undecided, one that is out of it by no more than the accuracy, if one was found.
  std::optional<ToleranceWitness> witness{};
  bool at_lower = false;  ///< the limit that the witness exceeds or, without one, that was not proven
  /// If undecided: no point is out of the tolerance by more than this. At most the accuracy, unless the
  /// search ended at ToleranceProofOptions::most_parts. Nothing if signs are the reason.
  std::optional<double> undecided_by{};
  /// Undecided because it depends on signs that are estimates (is_estimate()): some point
  /// is within the tolerance with one sign and out of it with the other, and of SignMethod::side, that it has
  /// the right one is not proven.
  bool depends_on_signs = false;
  /// Set with ToleranceProofOptions::facing: the number of faces of the surface with an area, but without an
  /// allowed face of O2. They have no distance, so that the tolerance never holds.
  std::size_t faces_without_match = 0;
};

template <>
inline constexpr std::tuple kFields<ToleranceProof>{
    Field{"witness", &ToleranceProof::witness,
          "A point between texels and vertices that is out of the tolerance, if the verdict depends on one."},
    Field{"undecided_by", &ToleranceProof::undecided_by,
          "If not decided: no point is out of the tolerance by more than this. Nothing if it is not known."},
    Field{"depends_on_signs", &ToleranceProof::depends_on_signs,
          "It is not decided because of signs that are estimates."},
    Field{"faces_without_match", &ToleranceProof::faces_without_match,
          "The number of faces that no face of O2 faces: they have no distance."}};

/// Options of prove_tolerance().
struct ToleranceProofOptions {
  SignMethod sign = SignMethod::automatic;  ///< as of a map
  /// Distances that exceed a limit by no more than this, in units of the meshes, are not out of the
  /// tolerance, as rounding may be the reason; but no tolerance is proven to hold with such a distance. ≥ 0
  double accuracy = 0;
  /// Distances are those of maps with MapOptions::facing, to the faces of O2 that face the same way. They are
  /// 1-Lipschitz within each face of the surface, so that symmetric limits are decided for every point.
  /// Others are decided as with estimated signs, by |d| alone.
  std::optional<double> facing{};
  /// The faces of the surface that matter; by default all.
  std::optional<std::span<const std::uint32_t>> faces{};
  /// The search ends, undecided, after so many parts of the surface were examined in one step of the proof.
  std::size_t most_parts = std::size_t{1} << 20;
  Progress progress{};
};

/// Decides whether all points of a surface have distances to O2 within a tolerance, by branch and bound as of
/// one_sided_hausdorff(), which ends as soon as the answer is known. Unsigned distances are never negative,
/// so that a lower limit of 0 or less holds. Each side of O2 has its own limits: signs are decided exactly
/// where the distance exceeds a limit. With estimated signs, what |d| alone decides is proven: points that
/// are within the tolerance with either sign, such as those on O2, are within it. Of SignMethod::side, those
/// that are within it with one sign only are, if that is their side for each site of O2 that may be the
/// closest one. The rest is undecided with `depends_on_signs`: points out of the tolerance on their side,
/// points whose closest site may be on the boundary of O2, and where sites that are equally close disagree;
/// any such point of SignMethod::winding, and with `facing`.
///
/// A proof holds to 1e-12 of the diagonal of both meshes and of their largest coordinate. It is undecided
/// only if the most extreme distance is that close to a limit, or beyond it by no more than the accuracy; if
/// it depends on estimated signs; or at the end of the search (`most_parts`), which happens where the surface
/// touches O2 at a limit of 0 that distinguishes signs. The result does not depend on the number of threads.
///
/// Throws sdm::Error if the surface is unusable (see validate), for a face that it does not have, a tolerance
/// that is not finite and ordered, an accuracy that is negative or NaN, a sign method that O2 does not
/// permit or that distances with `facing` do not have, an angle out of range, a tolerance that needs a sign
/// where distances have none, or if there is not enough memory; Cancelled. Cost: as of one_sided_hausdorff(),
/// but only near the points that may be out of the tolerance.
[[nodiscard]] SDM_API ToleranceProof prove_tolerance(const Mesh& surface, const Sites& sites,
                                                     const Tolerance& tolerance,
                                                     const ToleranceProofOptions& options = {});

}  // namespace sdm
