// Sequences from animated morph targets of a glTF file.
#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "io/mesh/frames/frame_source.h"
#include "io/mesh/gltf/document/gltf_rows.h"
#include "io/mesh/gltf/gltf_morph.h"
#include "io/mesh/gltf/gltf_scene.h"
#include "io/mesh/gltf/gltf_skin.h"
#include "io/mesh/gltf/gltf_weights.h"

namespace sdm::io {
namespace {

using nlohmann::json;

// A vertex that a morph target displaces, in the coordinates of the scene.
struct Displaced {
  std::uint32_t vertex;
  Vec3 displacement;
};

// The vertices of a primitive of an animated node: position = rest + Σ weight · displacement.
struct MorphedPart {
  std::size_t first_vertex, track;
  std::vector<std::vector<Displaced>> targets;
};

// The samplers of the first animation that changes only weights, by node.
std::map<std::size_t, const json*> weight_samplers(const json& animations) {
  std::map<std::size_t, const json*> samplers;
  for (const json& animation : animations) {
    bool moves_nodes = false;
    for (const json& channel : animation.at("channels")) {
      const json& target = channel.at("target");
      if (target.at("path") != "weights") {
        moves_nodes = true;
      } else if (target.contains("node")) {
        samplers[whole_number(target, "node")] =
            &animation.at("samplers").at(whole_number(channel, "sampler"));
      }
    }
    if (!samplers.empty() && moves_nodes) samplers.clear();
    if (!samplers.empty()) break;
  }
  if (samplers.empty())
    throw Error(
        "the animation moves nodes, but only the weights of morph targets are read; save the motion as "
        "numbered meshes");
  return samplers;
}

// A skin moves each vertex by a fixed transform, which applies to the displacements, too.
std::vector<std::vector<Displaced>> targets_of(const GltfDocument& document, const json& primitive,
                                               const GltfPlacement& placement) {
  std::vector<std::vector<Displaced>> result;
  for (const std::optional<GltfRows>& rows : gltf_displacements(document, primitive)) {
    std::vector<Displaced>& displaced = result.emplace_back();
    if (!rows) continue;
    document.charge(rows->stored_rows() * sizeof(Displaced), "the morph targets");
    displaced.reserve(rows->stored_rows());
    for (std::size_t i = 0; i < rows->stored_rows(); ++i) {
      const std::size_t v = rows->stored_row(i);
      displaced.push_back({static_cast<std::uint32_t>(v), placement[v].turn(rows->vec3(v))});
    }
  }
  return result;
}

class GltfFrames : public FrameSource {
 public:
  GltfFrames(const GltfDocument& document, std::filesystem::path file, std::optional<double> rate)
      : file_(std::move(file)) {
    const auto samplers = weight_samplers(list_of(document.root(), "animations"));
    const std::vector<GltfInstance> instances = gltf_instances(document);
    std::set<std::size_t> animated;
    for (const auto& [node, sampler] : samplers) animated.insert(node);
    polygons_ = read_gltf_scene(document, instances, animated);
    rest_ = polygons_.positions;
    GltfSkins skins(document);
    std::map<std::size_t, std::size_t> track_of_node;
    std::size_t first_vertex = 0;
    for (const GltfInstance& instance : instances) {
      const auto sampler = samplers.find(instance.node);
      const bool moves = sampler != samplers.end();
      if (moves && track_of_node.try_emplace(instance.node, tracks_.size()).second)
        tracks_.emplace_back(document, *sampler->second, gltf_target_count(document, instance.mesh));
      for (const json& primitive : list_of(document.item("meshes", instance.mesh), "primitives")) {
        if (!has_triangles(document, primitive)) continue;
        if (moves)
          parts_.push_back({first_vertex, track_of_node[instance.node],
                            targets_of(document, primitive, skins.placement(instance, primitive))});
        first_vertex += document.count(whole_number(primitive["attributes"], "POSITION"));
      }
    }
    if (parts_.empty()) throw Error("the animation does not change any mesh of the scene");
    choose_times(rate);
  }

  PolygonMesh take_polygons() override {
    GltfFrames::read(0, polygons_.positions);
    return std::move(polygons_);
  }

  std::size_t count() const override { return count_; }

  std::string name(std::size_t frame) const override {
    return fmt::format("{} at {:g} s", file_.filename().string(), time(frame));
  }
  std::vector<std::filesystem::path> files() const override { return {file_}; }

  void read(std::size_t frame, std::vector<Vec3>& positions) override {
    positions = rest_;
    for (const MorphedPart& part : parts_) {
      weights_.assign(tracks_[part.track].targets(), 0.0);
      tracks_[part.track].sample(time(frame), weights_);
      for (std::size_t t = 0; t < part.targets.size(); ++t)
        for (const auto& [v, displacement] : part.targets[t])
          positions[part.first_vertex + v] += weights_[t] * displacement;
    }
  }

 private:
  // Frames are at the keys of all tracks, or in equal steps from the first key to the last.
  void choose_times(std::optional<double> rate) {
    for (const WeightTrack& track : tracks_)
      key_times_.insert(key_times_.end(), track.times().begin(), track.times().end());
    std::ranges::sort(key_times_);
    key_times_.erase(std::unique(key_times_.begin(), key_times_.end()), key_times_.end());
    count_ = key_times_.size();
    if (!rate) return;
    interval_ = 1 / *rate;
    constexpr double kStepRounding = 1e-6;  // as a fraction of a step
    const double steps = std::floor((key_times_.back() - key_times_.front()) * *rate + kStepRounding);
    if (!(steps < 1e9)) throw Error("has more than a billion frames at this rate; choose a lower one");
    count_ = static_cast<std::size_t>(steps) + 1;
  }

  double time(std::size_t frame) const {
    return interval_ == 0 ? key_times_[frame] : key_times_.front() + interval_ * static_cast<double>(frame);
  }

  std::filesystem::path file_;
  PolygonMesh polygons_;
  std::vector<Vec3> rest_;
  std::vector<WeightTrack> tracks_;  // one for each animated node
  std::vector<MorphedPart> parts_;
  std::vector<double> key_times_, weights_;
  double interval_ = 0;
  std::size_t count_ = 0;
};

}  // namespace

std::unique_ptr<FrameSource> gltf_frames(std::string_view bytes, const std::filesystem::path& file,
                                         std::optional<double> rate) {
  try {
    const GltfDocument document(bytes, file.parent_path());
    if (list_of(document.root(), "animations").empty()) return nullptr;
    return std::make_unique<GltfFrames>(document, file, rate);
  } catch (const json::exception& fault) {
    throw_gltf_fault(fault);
  }
}

}  // namespace sdm::io
