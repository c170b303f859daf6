/// Doubts that withhold a PASS: signs that what was measured is not what was meant.
///
/// Threads: the functions may be called concurrently.
#pragma once

#include <sdm/align.h>
#include <sdm/api.h>
#include <sdm/coverage.h>
#include <sdm/fit_check.h>
#include <sdm/names.h>
#include <sdm/unit_check.h>

#include <array>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

namespace sdm {

/// What a doubt is about.
enum class DoubtReason {
  other_unit,    ///< in another unit of length, O1 fits O2 far better
  mirrored,      ///< the mirror image of O1 fits O2 far better
  poor_fit,      ///< after an alignment, most samples of O1 do not fit O2
  undetermined,  ///< the surfaces do not determine all freedoms of the alignment
  low_coverage,  ///< too little of O2 has a measured point near it
  thin_walls,    ///< the closest point may be on the other skin of a wall, and nothing else decides
};

template <>
inline constexpr std::array kWords<DoubtReason>{"other unit",   "mirrored",     "poor fit",
                                                "undetermined", "low coverage", "thin walls"};

/// A reason not to trust that all distances are within a tolerance, although they are.
struct Doubt {
  DoubtReason reason = DoubtReason::other_unit;
  std::string text{};    ///< a clause: what was found
  std::string remedy{};  ///< a clause: what mends it, by the options of the command
};

template <>
inline constexpr std::tuple kFields<Doubt>{
    Field{"reason", &Doubt::reason, "What it is about."}, Field{"text", &Doubt::text, "What was found."},
    Field{"remedy", &Doubt::remedy, "What mends it, by the options of the command."}};

/// Returns the doubts that an alignment leaves: O1 fits in another unit, or mirrored, less than half of the
/// samples fit (Alignment::fraction_fitting), or a degree of freedom is free.
[[nodiscard]] SDM_API std::vector<Doubt> doubts_of(const Alignment& alignment,
                                                   const std::optional<OtherUnit>& other_unit,
                                                   const std::optional<MirroredFit>& mirrored = {});

/// Returns the doubt that O1 is in another unit, of find_other_unit() or find_other_unit_in_place().
[[nodiscard]] SDM_API Doubt doubt_of(const OtherUnit& unit);

/// Returns the doubt that a coverage below `least` leaves: by its value, not by its bounds.
[[nodiscard]] SDM_API std::optional<Doubt> doubt_of(const Coverage& coverage, double least);

}  // namespace sdm
