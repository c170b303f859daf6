#include "io/mesh/gltf/gltf_animation.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <string>

#include "io/mesh/gltf/gltf_morph.h"

namespace sdm::io {
namespace {

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
