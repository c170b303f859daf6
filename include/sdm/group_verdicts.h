/// Verdicts on the named groups of a surface, each with a tolerance of its own.
///
/// Threads: the functions may be called concurrently, also with the same map.
#pragma once

#include <sdm/api.h>
#include <sdm/certified_verdict.h>
#include <sdm/map.h>
#include <sdm/names.h>
#include <sdm/part_statistics.h>
#include <sdm/sites.h>
#include <sdm/surface.h>
#include <sdm/tolerance.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

namespace sdm {

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
  /// Of the distances to faces that face the same way, if walls are thin.
  std::optional<Evidence> by_facing{};
};

/// Options of certify_groups().
struct CertifyGroupsOptions {
  double accuracy = 0;         ///< of the distances: engine_accuracy(); infinite if unknown
  bool doubted = false;        ///< there are doubts that withhold a pass
  bool accept_doubts = false;  ///< doubt_of() a verdict leaves a pass one
  double guard = 0;            ///< Evidence::guard
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
