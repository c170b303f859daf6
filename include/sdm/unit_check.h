/// Whether O1 fits O2 far better in another unit of length.
///
/// Threads: the functions may be called concurrently, also with the same Sites.
#pragma once

#include <sdm/align.h>
#include <sdm/api.h>
#include <sdm/mesh.h>
#include <sdm/sites.h>

#include <optional>
#include <span>

namespace sdm {

/// O1 times a ratio of two units fits better. Both misfits are estimates: the rms distance of samples of the
/// aligned O1 to O2, as a fraction of the radius of gyration of O1 at that size.
struct OtherUnit {
  double factor = 1;  ///< 10, 25.4, 304.8 or 1000, or the inverse of one
  double misfit = 0;
  double misfit_as_given = 0;
  bool same_box = false;  ///< of find_other_unit_in_place(): O1 has the box of O2 at that size
};

/// Aligns O1, times each ratio of two common units of length, to O2 as align() does with these options, and
/// returns the ratio whose misfit is the least, if it is at most a quarter of that of O1 as it is. `found`:
/// the alignment of O1 as it is, with the same options. Nothing if O1 fits as it is, to 2 % of its radius of
/// gyration, or if no ratio fits to 10 %. O1 is scaled about the origin of its coordinates, as a conversion
/// of units does. A flat O1 fits in any unit. Errors as of align(). Cost: linear in O1, and that of up to 8
/// alignments of 1024 samples.
[[nodiscard]] SDM_API std::optional<OtherUnit> find_other_unit(const Mesh& o1, const Sites& o2,
                                                               const Alignment& found,
                                                               const AlignOptions& options = {});

/// The same for points.
[[nodiscard]] SDM_API std::optional<OtherUnit> find_other_unit(std::span<const Vec3> points,
                                                               std::span<const Vec3> normals, const Sites& o2,
                                                               const Alignment& found,
                                                               const AlignOptions& options = {});

/// The same without an alignment, for an O1 that is in place: returns the ratio of two units that scales O1,
/// about the origin of its coordinates, to the box of O2, up to 5 % of the diagonal; otherwise the one whose
/// misfit is the least, if that is at most 2 % and a quarter of a misfit as given above 2 %. Nothing unless
/// sizes_differ(). Throws sdm::Error if a mesh is unusable (see validate), or if there is not enough memory.
/// Cost: linear in O1; if the sizes differ, also that of Sites of O2.
[[nodiscard]] SDM_API std::optional<OtherUnit> find_other_unit_in_place(const Mesh& o1, const Mesh& o2);

/// The same for points, all with finite coordinates. Nothing without points.
[[nodiscard]] SDM_API std::optional<OtherUnit> find_other_unit_in_place(std::span<const Vec3> points,
                                                                        const Mesh& o2);

/// Whether the diagonals of two boxes differ as much as units do: by more than 5 times.
[[nodiscard]] SDM_API bool sizes_differ(const Box& a, const Box& b);

}  // namespace sdm
