#include <sdm/doubts.h>

#include <algorithm>
#include <cmath>

#include "core/larger_units.h"
#include "core/numbers/number_text.h"

namespace sdm {
namespace {

/// What was found, of an O1 that is so many times too small or too large.
std::string found_text(const OtherUnit& unit, const std::string& times) {
  if (unit.same_box) return "O1 has the size and the place of O2 if it is " + times;
  constexpr double kLeastShown = 1e-5;
  const std::string misfit =
      unit.misfit < kLeastShown ? "less than 0.001" : number_text(100 * unit.misfit, 2);
  return "O1 fits O2 far better " + times + " (to " + misfit + " % of its size, instead of " +
         number_text(100 * unit.misfit_as_given, 2) + " %)";
}

Doubt unit_doubt(const OtherUnit& unit) {
  const bool grows = unit.factor > 1;
  const double ratio = grows ? unit.factor : 1 / unit.factor;
  const LargerUnit& larger = *std::ranges::min_element(
      kLargerUnits, {}, [&](const LargerUnit& l) { return std::abs(l.millimetres - ratio); });
  const char* const smaller = "millimetres";
  const std::string o1 = grows ? larger.name : smaller, o2 = grows ? smaller : larger.name;
  constexpr int kExact = 15;  // digits: ratios of units are decimal numbers, or their inverses
  return {DoubtReason::other_unit,
          found_text(unit, number_text(ratio, 4) + " times as " + (grows ? "large" : "small") +
                               ", as if it were in " + o1 + " and O2 in " + o2),
          // Not --units-o1 and --units-o2: these also scale O2 where --units names another unit, so that a
          // tolerance would mean another length than in this run.
          "--transform-o1 scale:" + number_text(unit.factor, kExact) +
              ", after the steps it already has, converts O1 alone"};
}

Doubt mirror_doubt(const MirroredFit& fit) {
  constexpr double kLeastShown = 1e-5;
  const std::string misfit = fit.misfit < kLeastShown ? "less than 0.001" : number_text(100 * fit.misfit, 2);
  return {DoubtReason::mirrored,
          "O1 fits O2 far better mirrored (to " + misfit + " % of its size, instead of " +
              number_text(100 * fit.misfit_as_given, 2) + " %)",
          "compare it with the part of the other hand, or mirror it by --transform-o1 matrix:FILE"};
}

}  // namespace

std::vector<Doubt> doubts_of(const Alignment& alignment, const std::optional<OtherUnit>& other_unit,
                             const std::optional<MirroredFit>& mirrored) {
  constexpr double kLeast = 0.5;
  std::vector<Doubt> doubts;
  if (other_unit) doubts.push_back(unit_doubt(*other_unit));
  if (mirrored) doubts.push_back(mirror_doubt(*mirrored));
  if (alignment.fraction_fitting < kLeast)
    doubts.push_back(
        {DoubtReason::poor_fit,
         number_text(100 * (1 - alignment.fraction_fitting), 3) +
             " % of the samples of the aligned O1 do not fit O2",
         "start the alignment elsewhere (--align-from), or give the parts that belong together"});
  const auto free = std::ranges::count_if(alignment.freedoms, &DegreeOfFreedom::free);
  if (free > 0)
    doubts.push_back({DoubtReason::undetermined,
                      "the surfaces do not determine " + std::to_string(free) +
                          (free == 1 ? " freedom" : " freedoms") + " of the alignment",
                      "place O1 by --transform-o1 instead of --align, or lock them by --align-free"});
  return doubts;
}

Doubt doubt_of(const OtherUnit& unit) {
  return unit_doubt(unit);
}

std::optional<Doubt> doubt_of(const Coverage& coverage, double least) {
  if (!(coverage.value < least)) return std::nullopt;
  return Doubt{DoubtReason::low_coverage,
               "only " + number_text(100 * coverage.value, 3) +
                   " % of the area of O2 has a measured point within " + number_text(coverage.reach, 5) +
                   ", less than " + number_text(100 * least, 3) + " %",
               "measure the rest, or choose a lower --min-coverage"};
}

}  // namespace sdm
