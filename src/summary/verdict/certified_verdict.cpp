#include <sdm/error.h>
#include <sdm/measure.h>
#include <sdm/summary.h>
#include <sdm/verdict.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "certify/prove_tolerance.h"
#include "closest/facing/facing_normals.h"
#include "core/rules.h"
#include "map/places/largest_place.h"
#include "map/statistics/texel_areas.h"
#include "summary/verdict/certify.h"
#include "summary/verdict/evidence.h"

namespace sdm {
namespace {

/// The angle within which faces face the same way where nothing else is asked for.
constexpr double kSameWay = 90;

/// Whether a proof may decide what the samples leave open.
bool is_open(const ToleranceVerdict& verdict, SignMethod sign) {
  switch (verdict.reason) {
    case VerdictReason::between_samples:
    case VerdictReason::within_rounding:
    case VerdictReason::guard_band:
      return true;
    case VerdictReason::all_within:  // of samples only
      return !verdict.certified;
    case VerdictReason::estimated_signs:  // unless with the other sign a sample is out of the tolerance
      return verdict.margin > 0 || sign == SignMethod::side;
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
    case Proof::holds:
      result.verdict = Verdict::pass;
      result.reason = VerdictReason::all_within;
      result.certified = true;
      break;
    case Proof::fails:
      result.verdict = Verdict::fail;
      result.reason = proof.witness ? VerdictReason::exceeded : VerdictReason::without_match;
      result.certified = true;
      result.within = false;
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

Tolerance summary::Certifier::real_limits(const Tolerance& tolerance) const {
  const bool is_signed = map_.sign.method != SignMethod::none;
  return is_signed || tolerance.lower > 0 ? tolerance : Tolerance(-kInfinity, tolerance.upper);
}

bool summary::Certifier::are_walls_thin(const Tolerance& tolerance) {
  if (!options_.thin_walls) options_.thin_walls = thin_walls(sites_);
  return 2 * largest_limit(real_limits(tolerance)) > *options_.thin_walls;
}

const hausdorff::Matching& summary::Certifier::matching(double angle) {
  if (!matching_) matching_.emplace(tolerance::matching_of(surface_, sites_, angle));
  return *matching_;
}

const hausdorff::Matching& summary::Certifier::reversed_matching(double angle) {
  if (!reversed_) {
    std::vector<Vec3> normals = facing::outward_normals(surface_);
    for (Vec3& normal : normals) normal = -1.0 * normal;
    reversed_.emplace(internals(sites_), angle, std::move(normals));
  }
  return *reversed_;
}

/// Returns nothing if the guard band leaves nothing of the tolerance.
std::optional<ToleranceProof> summary::Certifier::prove(const Tolerance& tolerance,
                                                        std::optional<double> facing,
                                                        const hausdorff::Matching* matching,
                                                        const Faces& faces) {
  const Tolerance limits = real_limits(tolerance);
  const double guard = options_.guard + options_.uncertainty;
  const Tolerance inner(limits.lower + guard, limits.upper - guard);
  if (!(inner.lower <= inner.upper)) return std::nullopt;
  if (!box_) box_ = bounds(sites_.mesh());
  const bool by_side = facing && map_.sign.method != SignMethod::none;
  ToleranceProof proof = tolerance::prove_valid(surface_, sites_, guard > 0 ? inner : tolerance,
                                                {.sign = by_side ? SignMethod::side : map_.sign.method,
                                                 .accuracy = options_.accuracy + 2 * guard,
                                                 .facing = facing,
                                                 .faces = faces,
                                                 .progress = options_.progress},
                                                {*box_, matching});
  if (proof.undecided_by) *proof.undecided_by = std::max(0.0, *proof.undecided_by - guard);
  return proof;
}

/// A surface without an outside may be inside out: what is then out of the limits proves nothing if it is
/// within them the other way round.
void summary::Certifier::decide_by_facing(CertifiedVerdict& verdict, const Faces& faces) {
  verdict.proof = prove(verdict.tolerance, kSameWay, &matching(kSameWay), faces);
  if (verdict.proof && verdict.proof->proof == Proof::fails) {
    if (!has_outside_) has_outside_ = facing::has_outside(surface_);
    if (!*has_outside_ &&
        prove(verdict.tolerance, kSameWay, &reversed_matching(kSameWay), faces)->proof == Proof::holds)
      verdict.proof = ToleranceProof{.depends_on_signs = true};
  }
  verdict.by_facing = verdict.proof && verdict.proof->proof != Proof::undecided;
  if (*verdict.by_facing)
    static_cast<Judgement&>(verdict) = judge(verdict, *verdict.proof);
  else
    leave_in_doubt(verdict);
}

void summary::Certifier::leave_in_doubt(CertifiedVerdict& verdict) const {
  verdict.by_facing = false;
  if (options_.accept_doubts) return;
  verdict.verdict = Verdict::doubtful;
  verdict.reason = VerdictReason::in_doubt;
}

void summary::Certifier::decide_by_places(CertifiedVerdict& verdict, const PlaceDecision& places) {
  verdict.by_places = places;
  verdict.certified = false;
  verdict.proof.reset();
  verdict.deciding_bound.reset();
  // Areas are rounded: with a share of 1, all of a surface is enough.
  const double least = (1 - 1e-6) * places.least;
  if (places.certain >= least) {
    verdict.verdict = Verdict::fail;
    if (verdict.reason > VerdictReason::without_match) verdict.reason = VerdictReason::exceeded;
    return;
  }
  const bool passes = places.possible < least;
  verdict.verdict = passes ? Verdict::pass : Verdict::not_decided;
  verdict.reason = passes ? VerdictReason::small_places : VerdictReason::guard_band;
  if (passes && may_cross_walls(map_.measured.kind) && are_walls_thin(verdict.tolerance))
    leave_in_doubt(verdict);
}

void summary::decide_thin_walls(CertifiedVerdict& verdict, const std::optional<Evidence>& by_facing,
                                bool accept_doubts) {
  if (verdict.reason != VerdictReason::thin_walls) return;
  verdict.verdict = Verdict::pass;
  verdict.reason = VerdictReason::all_within;
  verdict.certified = true;
  Judgement other{.verdict = Verdict::not_decided};
  if (by_facing) other = judge(*by_facing, verdict.tolerance);
  verdict.by_facing = other.verdict != Verdict::not_decided;
  if (*verdict.by_facing)
    static_cast<Judgement&>(verdict) = other;
  else if (!accept_doubts) {
    verdict.verdict = Verdict::doubtful;
    verdict.reason = VerdictReason::in_doubt;
  }
}

CertifiedVerdict summary::Certifier::operator()(const ToleranceVerdict& verdict, const Faces& faces) {
  CertifiedVerdict result{verdict, {}};
  const MeasuredDistance& measured = map_.measured;
  const bool is_facing = measured.facing.has_value();
  if (is_open(result, map_.sign.method) && is_provable(measured)) {
    result.proof =
        prove(verdict.tolerance, measured.facing, is_facing ? &matching(*measured.facing) : nullptr, faces);
    if (result.proof && !(is_facing && result.proof->depends_on_signs)) {
      static_cast<Judgement&>(result) = judge(result, *result.proof);
      if (result.reason == VerdictReason::within_rounding && options_.guard + options_.uncertainty > 0)
        result.reason = VerdictReason::guard_band;
    }
  }
  if (may_cross_walls(measured.kind) && result.verdict == Verdict::pass && are_walls_thin(verdict.tolerance))
    decide_by_facing(result, faces);
  return result;
}

namespace {

/// Whether places decide: not where something else than the size of what is out leaves it open, or where the
/// faces that face the same way fail, whose distances the map does not have.
bool may_places_decide(const CertifiedVerdict& verdict) {
  if (verdict.by_facing.value_or(false)) return verdict.verdict != Verdict::fail;
  switch (verdict.reason) {
    case VerdictReason::exceeded:
    case VerdictReason::beyond_max_distance:
    case VerdictReason::without_match:
    case VerdictReason::between_samples:
    case VerdictReason::within_rounding:
    case VerdictReason::guard_band:
      return true;
    default:
      return false;
  }
}

}  // namespace

CertifiedVerdict certify_tolerance(const Surface& surface, const Sites& sites, const DistanceMap& map,
                                   std::span<const float> vertex_distances, const Tolerance& tolerance,
                                   const CertifyOptions& options) {
  if (options.fail_area && options.fail_share) throw Error("fail_area excludes fail_share");
  Evidence evidence = evidence_of(surface, map, vertex_distances, options.error_bound, options.accuracy);
  evidence.guard = options.guard + options.uncertainty;
  evidence.uncertainty = options.uncertainty;
  ToleranceVerdict sampled = summary::check_evidence(surface, map, evidence, tolerance);
  summary::withhold_failures_by_missing_signs({&sampled, 1}, {}, surface, sites, map, vertex_distances,
                                              options.accuracy + evidence.guard);
  summary::Certifier certifier(surface.mesh(), sites, map, options);
  CertifiedVerdict verdict = certifier(sampled);
  if ((!options.fail_area && !options.fail_share) || !may_places_decide(verdict)) return verdict;
  const double error = options.accuracy + evidence.guard;
  Tolerance limits = tolerance;
  limits.lower = rules::lower_of(tolerance.lower, evidence.is_signed);
  const auto largest = [&](const Tolerance& within, double accuracy) {
    return map::largest_place(surface, map, vertex_distances, within, accuracy);
  };
  certifier.decide_by_places(
      verdict, {.least = options.fail_area ? *options.fail_area
                                           : *options.fail_share * map::surface_area(surface.mesh()),
                .certain = largest(limits, error),
                .possible = largest({limits.lower + error, limits.upper - error}, 0)});
  return verdict;
}

std::optional<Doubt> doubt_of(const CertifiedVerdict& verdict) {
  if (verdict.by_facing.value_or(true)) return std::nullopt;
  return Doubt{
      DoubtReason::thin_walls,
      "walls of O2 are thinner than twice the tolerance, where the closest point may be on the other "
      "skin, and the faces that face the same way do not decide",
      "measure to these (--facing, which needs normals and limits that are symmetric)"};
}

void withhold_pass(Summary& summary, bool accept_doubts) {
  if (!summary.tolerance || summary.doubts.empty() || accept_doubts) return;
  CertifiedVerdict& verdict = *summary.tolerance;
  if (verdict.verdict != Verdict::pass) return;
  verdict.verdict = Verdict::doubtful;
  verdict.reason = VerdictReason::in_doubt;
}

}  // namespace sdm
