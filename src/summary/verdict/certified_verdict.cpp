#include <sdm/certified_verdict.h>
#include <sdm/summary.h>

#include "certify/tolerance/prove_valid.h"
#include "summary/verdict/certify.h"
#include "summary/verdict/missing_signs.h"

namespace sdm {
namespace {

/// Whether a proof may decide what the samples leave open.
bool is_open(const ToleranceVerdict& verdict) {
  switch (verdict.reason) {
    case VerdictReason::between_samples:
    case VerdictReason::within_rounding:
      return true;
    case VerdictReason::all_within:  // of samples only
      return !verdict.certified;
    case VerdictReason::estimated_signs:  // unless with the other sign a sample is out of the tolerance
      return verdict.margin > 0;
    default:
      return false;
  }
}

}  // namespace

Judgement judge(const Judgement& of_samples, const ToleranceProof& proof) {
  Judgement result = of_samples;
  result.deciding_bound = 0;  // the proof does not depend on the map
  result.nearest_is_lower = proof.witness ? proof.at_lower : of_samples.nearest_is_lower;
  switch (proof.proof) {
    case Proof::inside:
      result.verdict = Verdict::pass, result.reason = VerdictReason::all_within;
      result.certified = true;
      break;
    case Proof::outside:
      result.verdict = Verdict::fail;
      result.reason = proof.witness ? VerdictReason::exceeded : VerdictReason::without_match;
      result.certified = true, result.within = false;
      break;
    case Proof::undecided:
      result.verdict = Verdict::not_decided;
      result.reason = proof.depends_on_signs ? VerdictReason::estimated_signs
                      : proof.witness        ? VerdictReason::within_rounding
                                             : VerdictReason::between_samples;
      break;
  }
  return result;
}

CertifiedVerdict summary::Certifier::operator()(const ToleranceVerdict& verdict,
                                                std::optional<std::span<const std::uint32_t>> faces) {
  CertifiedVerdict result{verdict, {}};
  const MeasuredDistance& measured = map_.measured;
  const bool is_facing = measured.kind == DistanceKind::facing && measured.facing;
  if (!is_open(result) || !(is_facing || measured.kind == DistanceKind::closest)) return result;
  if (!box_) box_ = bounds(sites_.mesh());
  if (is_facing && !matching_) matching_.emplace(tolerance::matching_of(surface_, sites_, *measured.facing));
  result.proof = tolerance::prove_valid(surface_, sites_, verdict.tolerance,
                                        {.sign = map_.sign.method,
                                         .accuracy = accuracy_,
                                         .facing = measured.facing,
                                         .faces = faces,
                                         .progress = progress_},
                                        {*box_, matching_ ? &*matching_ : nullptr});
  if (!(is_facing && result.proof->depends_on_signs))
    static_cast<Judgement&>(result) = judge(result, *result.proof);
  return result;
}

CertifiedVerdict certify_tolerance(const Surface& surface, const Sites& sites, const DistanceMap& map,
                                   std::span<const float> vertex_distances, const Tolerance& tolerance,
                                   const CertifyOptions& options) {
  ToleranceVerdict sampled =
      check_tolerance(surface, map, vertex_distances, options.error_bound, options.accuracy, tolerance);
  summary::withhold_failures_by_missing_signs({&sampled, 1}, {}, surface, sites, map, vertex_distances,
                                              options.accuracy);
  return summary::Certifier(surface.mesh(), sites, map, options.accuracy, options.progress)(sampled);
}

void withhold_pass(Summary& summary, bool accept_doubts) {
  if (!summary.tolerance || summary.doubts.empty() || accept_doubts) return;
  CertifiedVerdict& verdict = *summary.tolerance;
  if (verdict.verdict != Verdict::pass) return;
  verdict.verdict = Verdict::doubtful, verdict.reason = VerdictReason::in_doubt;
}

}  // namespace sdm
