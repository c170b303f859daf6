// Sequences from animated morph targets of a glTF file.
#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/memory.h"
#include "io/read/frames/frame_source.h"
#include "io/read/gltf/gltf_scene.h"
#include "io/read/gltf/gltf_weights.h"

namespace sdm::io {
namespace {

using nlohmann::json;

// The vertices of a primitive of an animated node: position = rest + Σ weight · displacement. The linear part
// of the node's transform is already applied to the displacements.
struct MorphedPart {
  std::size_t first_vertex, track;
  std::vector<std::vector<Vec3>> displacements;  // for each target; empty if it has no positions
};

std::size_t target_count(const GltfDocument& document, std::size_t mesh) {
  std::size_t count = 0;
  for (const json& primitive : document.item("meshes", mesh).at("primitives"))
    count = std::max(count, primitive.value("targets", json::array()).size());
  return count;
}

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

std::vector<std::vector<Vec3>> displacements_of(const GltfDocument& document, const json& primitive,
                                                const GltfTransform& to_scene) {
  const std::size_t vertices = document.count(whole_number(primitive.at("attributes"), "POSITION"));
  std::vector<std::vector<Vec3>> result;
  for (const json& target : primitive.value("targets", json::array())) {
    std::vector<Vec3>& displacements = result.emplace_back();
    if (!target.contains("POSITION")) continue;
    const std::size_t accessor = whole_number(target, "POSITION");
    if (document.count(accessor) != vertices)
      throw Error("a morph target and its mesh differ in their number of vertices");
    require_memory(2 * vertices * sizeof(Vec3), "the morph targets");
    const GltfNumbers numbers = document.numbers(accessor);
    if (numbers.columns != 3) throw Error("the positions of a morph target are not of type VEC3");
    displacements.reserve(vertices);
    for (std::size_t v = 0; v < vertices; ++v) {
      const double* d = numbers.row(v);
      displacements.push_back(to_scene.turn({d[0], d[1], d[2]}));
    }
  }
  return result;
}

class GltfFrames : public FrameSource {
 public:
  GltfFrames(const GltfDocument& document, std::string file_name, double rate)
      : file_name_(std::move(file_name)), polygons_(read_gltf_scene(document)), rest_(polygons_.positions) {
    const auto samplers = weight_samplers(document.root().at("animations"));
    std::size_t first_vertex = 0;
    for (const GltfInstance& instance : gltf_instances(document)) {
      const auto sampler = samplers.find(instance.node);
      if (sampler != samplers.end())
        tracks_.emplace_back(document, *sampler->second, target_count(document, instance.mesh));
      for (const json& primitive : document.item("meshes", instance.mesh).at("primitives")) {
        if (!has_triangles(primitive)) continue;
        if (sampler != samplers.end())
          parts_.push_back(
              {first_vertex, tracks_.size() - 1, displacements_of(document, primitive, instance.to_scene)});
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
    return fmt::format("{} at {:g} s", file_name_, time(frame));
  }

  void read(std::size_t frame, std::vector<Vec3>& positions) override {
    positions = rest_;
    for (const MorphedPart& part : parts_) {
      weights_.assign(tracks_[part.track].targets(), 0.0);
      tracks_[part.track].sample(time(frame), weights_);
      for (std::size_t t = 0; t < part.displacements.size(); ++t)
        for (std::size_t v = 0; v < part.displacements[t].size(); ++v)
          positions[part.first_vertex + v] += weights_[t] * part.displacements[t][v];
    }
  }

 private:
  // Frames are at the keys of all tracks, or in equal steps from the first key to the last.
  void choose_times(double rate) {
    for (const WeightTrack& track : tracks_)
      key_times_.insert(key_times_.end(), track.times().begin(), track.times().end());
    std::ranges::sort(key_times_);
    key_times_.erase(std::unique(key_times_.begin(), key_times_.end()), key_times_.end());
    count_ = key_times_.size();
    if (rate == 0) return;
    interval_ = 1 / rate;
    constexpr double kRounding = 1e-6;  // as a fraction of a step
    const double steps = std::floor((key_times_.back() - key_times_.front()) * rate + kRounding);
    if (!(steps < 1e9)) throw Error("has more than a billion frames at this rate; choose a lower one");
    count_ = static_cast<std::size_t>(steps) + 1;
  }

  double time(std::size_t frame) const {
    return interval_ == 0 ? key_times_[frame] : key_times_.front() + interval_ * static_cast<double>(frame);
  }

  std::string file_name_;
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
                                         double rate) {
  try {
    const GltfDocument document(bytes, file.parent_path());
    if (document.root().value("animations", json::array()).empty()) return nullptr;
    return std::make_unique<GltfFrames>(document, file.filename().string(), rate);
  } catch (const json::exception& fault) {
    throw_gltf_fault(fault);
  }
}

}  // namespace sdm::io
