#include "io/mesh/gltf/gltf_track.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace sdm::io {
namespace {

constexpr std::size_t kQuaternion = 4;

// Spherical linear interpolation of unit quaternions (appendix C.4). q and −q are the same rotation, of which
// the nearer one is taken.
void interpolate_arc(const double* a, const double* b, double t, std::span<double> result) {
  double cosine = 0, sum = 0, difference = 0;
  for (std::size_t i = 0; i < kQuaternion; ++i) cosine += a[i] * b[i];
  const double sign = cosine < 0 ? -1 : 1;
  for (std::size_t i = 0; i < kQuaternion; ++i) {
    sum += (a[i] + sign * b[i]) * (a[i] + sign * b[i]);
    difference += (a[i] - sign * b[i]) * (a[i] - sign * b[i]);
  }
  // The arc cosine would be inaccurate at small angles. At most 90°, so that the sine is 0 only at 0.
  const double angle = 2 * std::atan2(std::sqrt(difference), std::sqrt(sum)), sine = std::sin(angle);
  const double of_a = sine == 0 ? 1 - t : std::sin((1 - t) * angle) / sine,
               of_b = sine == 0 ? t : std::sin(t * angle) / sine;
  for (std::size_t i = 0; i < kQuaternion; ++i) result[i] = of_a * a[i] + sign * of_b * b[i];
}

}  // namespace

GltfTrack GltfTrack::weights(const GltfDocument& document, const nlohmann::json& sampler,
                             std::size_t targets) {
  return {document, sampler, targets, "weights", fmt::format("{} targets", targets)};
}

GltfTrack GltfTrack::vectors(const GltfDocument& document, const nlohmann::json& sampler,
                             std::string_view path) {
  return {document, sampler, 3, "numbers", path};
}

GltfTrack GltfTrack::rotations(const GltfDocument& document, const nlohmann::json& sampler) {
  GltfTrack track(document, sampler, kQuaternion, "numbers", "rotation");
  if (track.interpolation_ == Interpolation::linear) {
    track.interpolation_ = Interpolation::arc;
    track.make_unit_length();
  }
  return track;
}

GltfTrack::GltfTrack(const GltfDocument& document, const nlohmann::json& sampler, std::size_t columns,
                     std::string_view values, std::string_view row)
    : columns_(columns) {
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
  const std::size_t rows_per_key = interpolation_ == Interpolation::cubic ? 3 : 1;
  if (columns_ == 0 || values_.size() % rows_per_key != 0 || values_.size() / rows_per_key % columns_ != 0 ||
      values_.size() / rows_per_key / columns_ != times_.size())
    throw Error(
        fmt::format("the animation has {} {} for {} keys of {}", values_.size(), values, times_.size(), row));
}

void GltfTrack::make_unit_length() {
  for (std::size_t first = 0; first < values_.size(); first += kQuaternion) {
    double squared_length = 0;
    for (std::size_t i = 0; i < kQuaternion; ++i) squared_length += values_[first + i] * values_[first + i];
    if (squared_length == 0) throw Error("the animation has a rotation that is a quaternion of length 0");
    for (std::size_t i = 0; i < kQuaternion; ++i) values_[first + i] /= std::sqrt(squared_length);
  }
}

const double* GltfTrack::key(std::size_t k, int part) const {
  const std::size_t row =
      interpolation_ == Interpolation::cubic ? 3 * k + static_cast<std::size_t>(1 + part) : k;
  return values_.data() + row * columns_;
}

void GltfTrack::sample(double time, std::span<double> values) const {
  const auto after = static_cast<std::size_t>(std::ranges::upper_bound(times_, time) - times_.begin());
  const std::size_t before = after == 0 ? 0 : after - 1;
  if (after == 0 || after == times_.size() || time == times_[before] ||
      interpolation_ == Interpolation::step) {
    std::copy_n(key(before), columns_, values.begin());
    return;
  }
  interpolate(before, (time - times_[before]) / (times_[after] - times_[before]), values);
}

void GltfTrack::interpolate(std::size_t k, double t, std::span<double> values) const {
  const double *a = key(k), *b = key(k + 1);
  if (interpolation_ == Interpolation::arc) return interpolate_arc(a, b, t, values);
  if (interpolation_ == Interpolation::linear) {
    for (std::size_t i = 0; i < columns_; ++i) values[i] = (1 - t) * a[i] + t * b[i];
    return;
  }
  const double *out = key(k, 1), *in = key(k + 1, -1);
  const double span = times_[k + 1] - times_[k], t2 = t * t, t3 = t2 * t;
  for (std::size_t i = 0; i < columns_; ++i)
    values[i] = (2 * t3 - 3 * t2 + 1) * a[i] + span * (t3 - 2 * t2 + t) * out[i] + (3 * t2 - 2 * t3) * b[i] +
                span * (t3 - t2) * in[i];
}

}  // namespace sdm::io
