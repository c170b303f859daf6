#include <sdm/sampling_bound.h>

#include <new>

#include "core/cancellation.h"
#include "core/intact.h"
#include "core/memory.h"
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

}  // namespace sdm
