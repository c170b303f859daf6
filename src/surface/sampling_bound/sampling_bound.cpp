#include <sdm/error.h>
#include <sdm/sampling_bound.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <numbers>
#include <string>

#include "atlas/packing/pack.h"
#include "core/cancellation.h"
#include "core/intact.h"
#include "core/memory.h"
#include "core/numbers/number_text.h"
#include "geometry/rounding.h"
#include "surface/sampling_bound/piece_assignment.h"

namespace sdm {
struct SamplingBound::Impl {
  surface::PieceAssignment pieces;
  surface::PieceAssignment::Radii radii;
  Intact intact{"a SamplingBound object"};

  explicit Impl(const Surface& surface) : pieces(surface) { pieces.measure(surface, radii); }
};

SamplingBound::SamplingBound(const Surface& surface) try : impl_(std::make_unique<Impl>(surface)) {
} catch (const std::bad_alloc&) {
  throw out_of_memory("the sampling bound of the atlas");
}
SamplingBound::~SamplingBound() = default;
SamplingBound::SamplingBound(SamplingBound&&) noexcept = default;
SamplingBound& SamplingBound::operator=(SamplingBound&&) noexcept = default;

void SamplingBound::refit(const Surface& surface) try {
  const Uncancellable whole;
  impl_->intact.require();
  impl_->pieces.require_same(surface);
  impl_->intact.change([&] { impl_->pieces.measure(surface, impl_->radii); });
} catch (const std::bad_alloc&) {
  throw out_of_memory("the sampling bound of the atlas");
}

double SamplingBound::value() const {
  impl_->intact.require();
  return impl_->radii.largest;
}
double SamplingBound::value_after(double motion) const {
  return (1 + kDoubleRounding) * (value() + 2 * motion);
}
std::span<const float> SamplingBound::sample_radii() const {
  impl_->intact.require();
  return impl_->radii.samples;
}
std::span<const float> SamplingBound::face_radii() const {
  impl_->intact.require();
  return impl_->radii.faces;
}

const surface::PieceAssignment& internals(const SamplingBound& bound) {
  bound.impl_->intact.require();
  return bound.impl_->pieces;
}

namespace {

double ratio(double now, double first) {
  return first > 0 ? now / first : kInfinity;
}

void check_faces(std::size_t count, std::size_t expected) {
  if (count != expected)
    throw Error("a relative error of " + std::to_string(count) + " faces was asked for of a surface of " +
                std::to_string(expected) + "; compare a surface with its own initial geometry");
}

std::vector<double> lower_bounds(const Surface& first_shape, const SamplingBound& bound) {
  internals(bound).require_same(first_shape);
  return internals(bound).radius_lower_bounds(first_shape, bound.value());
}

}  // namespace

RelativeError::RelativeError(const Surface& first_shape, const SamplingBound& bound) try
    : first_(lower_bounds(first_shape, bound)), largest_(*std::ranges::max_element(first_)) {
} catch (const std::bad_alloc&) {
  throw out_of_memory("the sampling bound of the atlas");
}

double RelativeError::of(const SamplingBound& now) const {
  check_faces(now.face_radii().size(), first_.size());
  return ratio(now.value(), largest_);
}

double RelativeError::of_edited(const SamplingBound& now) const {
  return ratio(now.value(), largest_);
}

void RelativeError::of_faces(const SamplingBound& now, std::span<double> errors) const {
  check_faces(now.face_radii().size(), first_.size());
  check_faces(errors.size(), first_.size());
  std::ranges::transform(now.face_radii(), first_, errors.begin(), ratio);
}

namespace {

constexpr double kStep = 16, kMost = 32768;
constexpr double kGoodFactor = 0.9;  // neighbouring resolutions differ by as much

double area_of(const Mesh& mesh) {
  double doubled = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    doubled += norm(cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]));
  return doubled / 2;
}

double stepped(double resolution) {
  return kStep * std::clamp(std::ceil(resolution / kStep), 1.0, kMost / kStep);
}

/// About the factor by which the resolution must change; above 1 if and only if it does not suffice.
double needed_factor(const Mesh& mesh, AtlasOptions options, double resolution, double precision) try {
  options.resolution = static_cast<std::uint32_t>(resolution);
  return covering_radius(Surface(mesh, options)) / precision;
} catch (const atlas::TooSmall& error) {
  return static_cast<double>(error.enough()) / resolution;
}

/// The number of trials is not known in advance: each takes half of what remains.
Progress trial_progress(const Progress& progress, int trial) {
  if (!progress) return {};
  return [&progress, left = std::exp2(-trial)](std::string_view, double fraction) {
    return progress("resolution", 1 - left * (1 - fraction / 2));
  };
}

[[noreturn]] void throw_unreachable(double precision, double resolution) {
  throw Error("a precision of " + number_text(precision, 2) + " takes about " +
              number_text(resolution / kMost, 2) + " times the maximum of 32768 texels per side; use " +
              number_text(1.1 * precision * resolution / kMost, 2) + " or more");
}

}  // namespace

std::uint32_t resolution_for(const Mesh& mesh, double precision, const AtlasOptions& options) {
  check_options(PrecisionOptions{precision});
  if (options.rows)
    throw Error("a resolution for a precision is that of a square atlas; omit the number of rows");
  validate(mesh);
  // Typical of most atlases: seven tenths of the texels are owned, and points beside seams are a third
  // farther from a sample than the corners of squares.
  const double usual = 1.1 * std::sqrt(area_of(mesh)) / precision;
  // A trial at the maximum resolution takes tens of gigabytes: skip it if it cannot succeed.
  if (usual > 2 * kMost) throw_unreachable(precision, usual);

  // Trials that are too coarse and fine enough, with their factors.
  double coarse = 0, coarse_factor = 0, fine = 0, fine_factor = 0, resolution = stepped(usual);
  AtlasOptions of_trial = options;
  for (int trial = 0;; ++trial) {
    of_trial.progress = trial_progress(options.progress, trial);
    const double factor = needed_factor(mesh, of_trial, resolution, precision);
    (factor <= 1 ? fine : coarse) = resolution;
    (factor <= 1 ? fine_factor : coarse_factor) = factor;
    const double gap = std::max(kStep, kStep * std::floor(fine / 8 / kStep));
    if (fine > 0 && (fine_factor > kGoodFactor || fine - coarse <= gap))
      return static_cast<std::uint32_t>(fine);
    if (coarse == kMost) throw_unreachable(precision, factor * kMost);
    if (fine == 0) {
      resolution = stepped(std::max(factor, 1.125) * coarse);  // even where the bound hardly changes
    } else if (coarse == 0) {
      resolution = std::min(stepped(factor * fine), fine - gap);
    } else {
      // A power law through both trials; at least an eighth of the way from one to the other.
      const double exponent = std::log(coarse_factor) / std::log(coarse_factor / fine_factor);
      const double crossing = coarse * std::pow(fine / coarse, exponent);
      resolution = std::min(stepped(std::max(crossing, coarse + (fine - coarse) / 8)), fine - gap);
    }
  }
}

std::uint32_t resolution_for(const Mesh& mesh, const PrecisionOptions& options, const AtlasOptions& atlas) {
  check_options(options);
  if (options.precision) return resolution_for(mesh, *options.precision, atlas);
  if (options.texel_size) return resolution_for(mesh, *options.texel_size / std::numbers::sqrt2, atlas);
  return atlas.resolution;
}

}  // namespace sdm
