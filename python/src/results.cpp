// Pickling and copying of results that are values of the library: their members are listed here.
#include <sdm/doubts.h>
#include <sdm/mesh_edit.h>
#include <sdm/places.h>
#include <sdm/points.h>
#include <sdm/verdict.h>

#include "objects.h"
#include "values.h"

namespace sdm::python {

template <>
inline constexpr auto kMembers<CoverageMap> =
    std::tuple{&CoverageMap::value, &CoverageMap::lower,   &CoverageMap::upper,
               &CoverageMap::reach, &CoverageMap::of_face, &CoverageMap::pieces};
template <>
inline constexpr auto kMembers<CoveragePiece> =
    std::tuple{&CoveragePiece::face, &CoveragePiece::corners, &CoveragePiece::covered};

// Verdicts.
template <>
inline constexpr auto kLast<Proof> = Proof::undecided;
template <>
inline constexpr auto kMembers<Tolerance> = std::tuple{&Tolerance::lower, &Tolerance::upper};
template <>
inline constexpr auto kMembers<ToleranceProof> = std::tuple{
    &ToleranceProof::proof,        &ToleranceProof::witness,          &ToleranceProof::at_lower,
    &ToleranceProof::undecided_by, &ToleranceProof::depends_on_signs, &ToleranceProof::faces_without_match};
template <>
inline constexpr auto kMembers<CertifiedVerdict> = std::tuple{&CertifiedVerdict::verdict,
                                                              &CertifiedVerdict::reason,
                                                              &CertifiedVerdict::decision_rule,
                                                              &CertifiedVerdict::within,
                                                              &CertifiedVerdict::certified,
                                                              &CertifiedVerdict::margin,
                                                              &CertifiedVerdict::nearest_is_lower,
                                                              &CertifiedVerdict::deciding_bound,
                                                              &CertifiedVerdict::tolerance,
                                                              &CertifiedVerdict::largest,
                                                              &CertifiedVerdict::exceeded_area_fraction,
                                                              &CertifiedVerdict::shares,
                                                              &CertifiedVerdict::proof,
                                                              &CertifiedVerdict::by_facing};
template <>
inline constexpr auto kMembers<GroupVerdicts> =
    std::tuple{&GroupVerdicts::groups, &GroupVerdicts::without_group, &GroupVerdicts::verdict};

// Places.
template <>
inline constexpr auto kMembers<FaceNames> =
    std::tuple{&FaceNames::kind, &FaceNames::names, &FaceNames::of_face};

// Point clouds.
template <>
inline constexpr auto kMembers<PointDistances> = std::tuple{&PointDistances::points,
                                                            &PointDistances::invalid,
                                                            &PointDistances::beyond_max_distance,
                                                            &PointDistances::without_match,
                                                            &PointDistances::has_normals,
                                                            &PointDistances::format,
                                                            &PointDistances::text,
                                                            &PointDistances::sign,
                                                            &PointDistances::measured,
                                                            &PointDistances::distance,
                                                            &PointDistances::min,
                                                            &PointDistances::max,
                                                            &PointDistances::beyond_tolerance,
                                                            &PointDistances::beyond_with_either_sign,
                                                            &PointDistances::missing_signs_matter,
                                                            &PointDistances::islands,
                                                            &PointDistances::places,
                                                            &PointDistances::groups,
                                                            &PointDistances::accuracy,
                                                            &PointDistances::bounds};

// Alignments.
template <>
inline constexpr auto kMembers<Alignment> = std::tuple{
    &Alignment::transform,     &Alignment::before,           &Alignment::after,      &Alignment::samples,
    &Alignment::fraction_used, &Alignment::fraction_fitting, &Alignment::iterations, &Alignment::converged,
    &Alignment::centre,        &Alignment::gyration_radius,  &Alignment::freedoms,   &Alignment::groups};

void bind_result_states() {
  bind_value<DistanceStatistics>();
  bind_value<BoundedLength>();
  bind_value<SeparatingTranslation>();
  bind_value<CoverageMap>();
  bind_value<CertifiedVerdict>();
  bind_value<GroupVerdict>();
  bind_value<GroupVerdicts>();
  bind_value<FaceNames>([](const FaceNames& names) {
    for (const std::uint32_t name : names.of_face)
      if (name != kNone && name >= names.names.size()) throw Error(kDamaged);
  });
  bind_value<Place>();
  bind_value<Places>();
  bind_value<PointExtreme>();
  bind_value<PointDistances>();
  bind_value<Doubt>();
  bind_value<DegreeOfFreedom>();
  bind_value<Alignment>();
  bind_value<WeldReport>();
  bind_value<IslandReport>();
}

}  // namespace sdm::python
