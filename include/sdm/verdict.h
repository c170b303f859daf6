/// Verdicts on a tolerance that hold for every point of a surface, of the whole and of its named groups: by
/// the map where its error bound decides, otherwise by a proof.
///
/// Threads: the functions may be called concurrently, also with the same map.
#pragma once

#include <sdm/doubts.h>
#include <sdm/execution.h>
#include <sdm/map.h>
#include <sdm/mesh_attributes.h>
#include <sdm/names.h>
#include <sdm/sites.h>
#include <sdm/surface.h>
#include <sdm/tolerance.h>
#include <sdm/types.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

namespace sdm {

/// A verdict by connected places, of which only those of some size make a failure: noise puts single samples
/// out of a tolerance, and more of them the more samples there are. Areas are those of texels, so that all of
/// this is an estimate.
struct PlaceDecision {
  double least = 0;     ///< the area of a place that makes a failure, in squared units of the mesh
  double certain = 0;   ///< of the largest place out of the tolerance by more than accuracy and guard band
  double possible = 0;  ///< of the largest place that is not within it by more than these
};

template <>
inline constexpr std::tuple kFields<PlaceDecision>{
    Field{"least", &PlaceDecision::least,
          "The area that a connected place out of the tolerance needs for a 'fail', in squared units."},
    Field{"certain", &PlaceDecision::certain,
          "The area of the largest place that is out of it by more than the accuracy and the guard band."},
    Field{"possible", &PlaceDecision::possible,
          "The area of the largest place that is not within it by more than these."}};

/// A verdict, with the proof that led to it.
struct CertifiedVerdict : ToleranceVerdict {
  std::optional<ToleranceProof> proof{};  ///< where the samples of the map did not decide
  /// Set where walls of O2 are thinner than twice the tolerance, so that a pass by the closest points says
  /// nothing: whether distances to the faces of O2 that face the same way, within 90°, decide. The proof is
  /// of these.
  std::optional<bool> by_facing{};
  /// Set with CertifyOptions::fail_area or fail_share, where these decide.
  std::optional<PlaceDecision> by_places{};
};

/// What is known of every verdict.
template <>
inline constexpr auto kFields<CertifiedVerdict> = kFields<ToleranceVerdict>;

/// Returns the doubt about a pass by the closest points where walls are thin, and faces that face the same
/// way do not decide.
[[nodiscard]] SDM_API std::optional<Doubt> doubt_of(const CertifiedVerdict& verdict);

/// Options of certify_tolerance().
struct CertifyOptions {
  double error_bound = 0;              ///< of the map: covering_radius() of its surface
  double accuracy = 0;                 ///< of the distances: engine_accuracy(); infinite if unknown
  double guard = 0;                    ///< how far the meshes may be from the surfaces that are meant
  double uncertainty = 0;              ///< Evidence::uncertainty
  std::optional<double> thin_walls{};  ///< those of O2, if they are known
  bool accept_doubts = false;          ///< doubt_of() the verdict leaves a pass one
  std::optional<double> fail_area{};   ///< in squared units: a failure needs a connected place of this area
  std::optional<double> fail_share{};  ///< the same, as a share of the surface's area; excludes fail_area
  Progress progress{};
};

/// Returns the judgement that a proof leads to, of samples that alone decide nothing for every point.
[[nodiscard]] SDM_API Judgement judge(const Judgement& of_samples, const ToleranceProof& proof);

/// check_tolerance() and, where that does not decide because distances between the samples or the rounding of
/// a sample leave it open, prove_tolerance(). Verdict::not_decided remains for an extreme distance within the
/// accuracy of a limit, for what depends on signs that are estimates (see prove_tolerance()), where nothing
/// was measured, and for an unknown accuracy. Of DistanceKind::facing, where samples bound nothing, each pass
/// of the samples is proven: a proof of prove_tolerance() with the angle of the map, and Verdict::fail with
/// VerdictReason::without_match for a face that no face of O2 matches. Where asymmetric limits depend on
/// signs, their pass stays an estimate. Of other kinds, samples decide alone. Where distances are to the
/// closest point and walls of O2 are thinner than twice the tolerance (thin_walls()), a pass needs the proof
/// of DistanceKind::facing too, at 90°, which may make a failure of it; if that decides nothing, it is
/// Verdict::doubtful, for the reason of doubt_of().
///
/// With `fail_area` or `fail_share`, samples out of the tolerance, or without a value, do not decide alone
/// (PlaceDecision): Verdict::fail if the largest place that is certainly out is of that area, Verdict::pass
/// if the largest one that is possibly out is smaller, otherwise Verdict::not_decided; never certified.
/// Places are those of find_places(). What signs, thin walls or an unknown accuracy leave open stays so.
///
/// Errors as of check_tolerance() and prove_tolerance(), and if both fail_area and fail_share are given.
/// Cost: that of check_tolerance() and, unless it decides, of the proof.
[[nodiscard]] SDM_API CertifiedVerdict certify_tolerance(const Surface& surface, const Sites& sites,
                                                         const DistanceMap& map,
                                                         std::span<const float> vertex_distances,
                                                         const Tolerance& tolerance,
                                                         const CertifyOptions& options);

/// The verdict on a group.
struct GroupVerdict {
  std::string kind, group;                    ///< the kind of the name, as FaceNames::kind, and the name
  std::size_t faces = 0;                      ///< of the surface, or of O2 for a cloud
  std::uint64_t points = 0;                   ///< of a cloud: with a value, closest to these faces
  double area = 0;                            ///< of its texels, in squared units of the surface
  std::optional<double> lowest{}, highest{};  ///< of the distances of its texels and vertices
  CertifiedVerdict verdict;                   ///< shares are those of the area of the group, or of its points
};

template <>
inline constexpr std::tuple kFields<GroupVerdict>{
    Field{"kind", &GroupVerdict::kind, "The kind of the name."},
    Field{"group", &GroupVerdict::group, "The name."},
    Field{"faces", &GroupVerdict::faces, "The number of its faces."},
    Field{"points", &GroupVerdict::points, "Of a cloud: the number of points closest to these faces."},
    Field{"area", &GroupVerdict::area, "The area of its texels, in squared units; 0 of a cloud."},
    Field{"lowest", &GroupVerdict::lowest, "The least distance of its samples; nothing without a value."},
    Field{"highest", &GroupVerdict::highest, "The largest one."},
    Field{"verdict", &GroupVerdict::verdict,
          "Fractions of the area are those of the group, or of its points."}};

/// The points of a cloud that have coordinates but no value, and so no closest face: they are of no group.
struct PointsWithoutGroup {
  std::uint64_t beyond_max_distance = 0;  ///< O2 is farther than the maximum distance
  std::uint64_t without_match = 0;        ///< no face of O2 faces as they do

  [[nodiscard]] bool any() const { return beyond_max_distance + without_match > 0; }  ///< whether some are
};

template <>
inline constexpr std::tuple kFields<PointsWithoutGroup>{
    Field{"beyond_max_distance", &PointsWithoutGroup::beyond_max_distance,
          "Of a cloud: the number of points that are of no group, as the mesh is farther than the maximum "
          "distance."},
    Field{"without_match", &PointsWithoutGroup::without_match,
          "Of a cloud: the number of points that are of no group, as no face of the mesh faces as they do."}};

/// The verdicts on all groups of a table.
struct GroupVerdicts {
  std::vector<GroupVerdict> groups;  ///< in the order of the table
  PointsWithoutGroup without_group;  ///< of a cloud
  /// Verdict::fail if that of one group is, or if points are without a group, as a part may be missing or
  /// defective there; else Verdict::not_decided if that of one group is, else Verdict::pass, or
  /// Verdict::doubtful instead if there are doubts.
  Verdict verdict = Verdict::pass;
};

template <>
inline constexpr std::tuple kFields<GroupVerdicts>{
    Field{
        "verdict", &GroupVerdicts::verdict,
        "'fail' if that of one group is, or if points of a cloud are of no group; else 'not decided' if that "
        "of one is, else 'pass'."},
    Field{"groups", &GroupVerdicts::groups, "In the order of the table."}};

/// What the points of a cloud show of a group, which are those that are closest to its faces.
struct GroupPoints {
  std::string kind;
  GroupTolerance row;
  std::size_t faces = 0;
  std::uint64_t points = 0;            ///< with a value
  std::uint64_t below = 0, above = 0;  ///< out of the tolerance by more than the accuracy
  bool out_with_either_sign = true;    ///< a point is out whatever its sign, if it has none
  Evidence evidence{};                 ///< with error bound 0
  /// The evidence by the faces that face the same way, if walls are thin.
  std::optional<Evidence> by_facing{};
};

/// Options of certify_groups().
struct CertifyGroupsOptions {
  double accuracy = 0;         ///< of the distances: engine_accuracy(); infinite if unknown
  bool doubted = false;        ///< there are doubts that withhold a pass
  bool accept_doubts = false;  ///< doubt_of() a verdict leaves a pass one
  double guard = 0;            ///< how far the meshes may be from the surfaces that are meant
  double uncertainty = 0;      ///< Evidence::uncertainty
  Progress progress{};
};

/// Judges each group of `table` that `names`, those of the surface's faces, have: by its texels and vertices,
/// and where these are within the tolerance by prove_tolerance() of its faces, so that Verdict::pass holds
/// for every point of the group. A name of several kinds is that of the first. Faces that no row names are
/// not judged. Throws sdm::Error for a tolerance that needs a sign if the map is unsigned, and as
/// certify_tolerance() does. Cost: linear in texels and faces for all groups together, and for each group
/// that of its proof.
[[nodiscard]] SDM_API GroupVerdicts certify_groups(const Surface& surface, const Sites& sites,
                                                   const DistanceMap& map,
                                                   std::span<const float> vertex_distances,
                                                   std::span<const FaceNames> names,
                                                   std::span<const GroupTolerance> table,
                                                   const CertifyGroupsOptions& options);

/// Judges groups of points, whose distances have this sign and kind, and all of them together with the
/// points of no group. Fractions are of the points of the group. Verdict::doubtful where thin walls leave a
/// group open, unless these doubts are accepted. Cost: linear in groups.
[[nodiscard]] SDM_API GroupVerdicts judge_groups(std::span<const GroupPoints> groups,
                                                 const PointsWithoutGroup& without_group, SignMethod sign,
                                                 DistanceKind measured, bool accept_doubts = false);

/// Makes Verdict::doubtful of a pass on all groups, as there are doubts.
SDM_API void withhold_pass(GroupVerdicts& verdicts);

/// The verdicts on maps of parts of a surface, such as UDIM tiles, as of one map, in the order of the table:
/// that on a group is Verdict::fail if that of one of its parts is, and so on, as of all groups; fractions
/// are weighted by area. Where a name is of several kinds, `table` has those of the whole, as of
/// with_kinds(). Cost: linear.
[[nodiscard]] SDM_API GroupVerdicts combined_groups(std::span<const GroupVerdicts> parts,
                                                    std::span<const GroupTolerance> table, bool doubted);

}  // namespace sdm
