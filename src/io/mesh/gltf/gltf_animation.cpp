#include "io/mesh/gltf/gltf_animation.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "io/mesh/gltf/gltf_morph.h"

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

using nlohmann::json;

void add_channel(const GltfDocument& document, const json& animation, const json& channel,
                 GltfAnimation& result) {
  const json& target = channel.at("target");
  if (!target.contains("node")) return;
  const std::string& path = text_of(target.at("path"), "the path of a channel");
  const bool moves = path == "translation" || path == "rotation" || path == "scale";
  if (!moves && path != "weights") return;
  const std::size_t index = whole_number(target, "node"), sampler_index = whole_number(channel, "sampler");
  const json& node = document.item("nodes", index);
  const json& samplers = list_of(animation, "samplers");
  if (sampler_index >= samplers.size())
    throw Error(fmt::format("sampler {} of an animation is referred to but does not exist", sampler_index));
  const json& sampler = samplers[sampler_index];
  if (moves) {
    document.charge(sizeof(GltfMotion), "the animation");
    result.motions.try_emplace(index, document, index).first->second.add(document, path, sampler);
  } else if (node.contains("mesh")) {
    const std::size_t targets = gltf_target_count(document, whole_number(node, "mesh"));
    result.weights.insert_or_assign(index, GltfTrack::weights(document, sampler, targets));
  }
}

void append_times(const GltfTrack& track, std::vector<double>& times) {
  times.insert(times.end(), track.times().begin(), track.times().end());
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

GltfMotion::GltfMotion(const GltfDocument& document, std::size_t index) {
  const json& node = document.item("nodes", index);
  if (node.contains("matrix"))
    throw Error(
        fmt::format("the animation moves node {}, whose transform is a matrix, which glTF forbids", index));
  translation_ = Vec3{node.value("translation", std::array<double, 3>{})};
  rotation_ = node.value("rotation", std::array<double, 4>{0, 0, 0, 1});
  scale_ = Vec3{node.value("scale", std::array<double, 3>{1, 1, 1})};
}

void GltfMotion::add(const GltfDocument& document, const std::string& path, const json& sampler) {
  if (path == "rotation")
    rotations_ = GltfTrack::rotations(document, sampler);
  else
    (path == "scale" ? scales_ : translations_) = GltfTrack::vectors(document, sampler, path);
}

GltfTransform GltfMotion::at(double time) const {
  Vec3 translation = translation_, scale = scale_;
  std::array<double, 4> rotation = rotation_;
  if (translations_) translations_->sample(time, translation);
  if (rotations_) rotations_->sample(time, rotation);
  if (scales_) scales_->sample(time, scale);
  return gltf_transform(translation, rotation, scale);
}

void GltfMotion::add_times(std::vector<double>& times) const {
  for (const auto* track : {&translations_, &rotations_, &scales_})
    if (*track) append_times(**track, times);
}

std::vector<double> GltfAnimation::times() const {
  std::vector<double> times;
  for (const auto& [node, motion] : motions) motion.add_times(times);
  for (const auto& [node, track] : weights) append_times(track, times);
  std::ranges::sort(times);
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

GltfAnimation gltf_animation(const GltfDocument& document) {
  GltfAnimation result;
  for (const json& animation : list_of(document.root(), "animations")) {
    for (const json& channel : list_of(animation, "channels"))
      add_channel(document, animation, channel, result);
    if (!result.empty()) break;
  }
  return result;
}

}  // namespace sdm::io
