#include "io/mesh/gltf/gltf_weights.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace sdm::io {

WeightTrack::WeightTrack(const GltfDocument& document, const nlohmann::json& sampler, std::size_t targets)
    : targets_(targets) {
  const std::string name = sampler.value("interpolation", "LINEAR");
  if (name != "STEP" && name != "LINEAR" && name != "CUBICSPLINE")
    throw Error("the interpolation of the animation is none of STEP, LINEAR and CUBICSPLINE");
  interpolation_ = name == "STEP"     ? Interpolation::step
                   : name == "LINEAR" ? Interpolation::linear
                                      : Interpolation::cubic;
  times_ = document.numbers(whole_number(sampler, "input"));
  values_ = document.numbers(whole_number(sampler, "output"));
  if (times_.empty()) throw Error("the animation has no keys");
  for (std::size_t k = 0; k < times_.size(); ++k)
    if (!std::isfinite(times_[k]) || (k > 0 && times_[k] <= times_[k - 1]))
      throw Error(fmt::format("the times of the animation do not increase at key {}", k));
  const std::size_t numbers_per_key = interpolation_ == Interpolation::cubic ? 3 : 1;
  if (targets_ == 0 || values_.size() % numbers_per_key != 0 ||
      values_.size() / numbers_per_key % targets_ != 0 ||
      values_.size() / numbers_per_key / targets_ != times_.size())
    throw Error(fmt::format("the animation has {} weights for {} keys of {} targets", values_.size(),
                            times_.size(), targets_));
}

const double* WeightTrack::key(std::size_t k, int part) const {
  const std::size_t row =
      interpolation_ == Interpolation::cubic ? 3 * k + static_cast<std::size_t>(1 + part) : k;
  return values_.data() + row * targets_;
}

void WeightTrack::sample(double time, std::span<double> weights) const {
  const auto after = static_cast<std::size_t>(std::ranges::upper_bound(times_, time) - times_.begin());
  const std::size_t before = after == 0 ? 0 : after - 1;
  if (after == 0 || after == times_.size() || time == times_[before] ||
      interpolation_ == Interpolation::step) {
    std::copy_n(key(before), targets_, weights.begin());
    return;
  }
  const double span = times_[after] - times_[before], t = (time - times_[before]) / span;
  const double *a = key(before), *b = key(after);
  if (interpolation_ == Interpolation::linear) {
    for (std::size_t i = 0; i < targets_; ++i) weights[i] = (1 - t) * a[i] + t * b[i];
    return;
  }
  const double *out = key(before, 1), *in = key(after, -1);
  const double t2 = t * t, t3 = t2 * t;
  for (std::size_t i = 0; i < targets_; ++i)
    weights[i] = (2 * t3 - 3 * t2 + 1) * a[i] + span * (t3 - 2 * t2 + t) * out[i] + (3 * t2 - 2 * t3) * b[i] +
                 span * (t3 - t2) * in[i];
}

}  // namespace sdm::io
