// Sequences from the animation of a glTF file.
#include <fmt/format.h>
#include <sdm/error.h>

#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "io/mesh/frames/frame_source.h"
#include "io/mesh/gltf/gltf_morph.h"
#include "io/mesh/gltf/gltf_moving_part.h"
#include "io/mesh/gltf/gltf_scene.h"

namespace sdm::io {
namespace {

using nlohmann::json;

class GltfFrames : public FrameSource {
 public:
  GltfFrames(const GltfDocument& document, GltfAnimation animation, std::filesystem::path file,
             std::optional<double> rate)
      : file_(std::move(file)),
        key_times_(animation.times()),
        moment_{GltfPose(document, std::move(animation.motions))},
        weights_(std::move(animation.weights)) {
    if (key_times_.empty()) throw_without_change();
    choose_times(rate);
    moment_.pose.move_to(time(0));
    std::vector<GltfInstance> instances = gltf_instances(document);
    std::set<std::size_t> morphed;
    for (GltfInstance& instance : instances) {
      if (moment_.pose.carrier(instance.node))
        instance.to_scene = moment_.pose.to_scene(instance.node) * instance.to_node;
      if (weights_.contains(instance.node)) morphed.insert(instance.node);
    }
    polygons_ = read_gltf_scene(document, instances, morphed, false, &moment_.pose);
    rest_ = polygons_.positions;
    for (const GltfInstance& instance : instances) add_instance(document, instance);
    if (parts_.empty()) throw_without_change();
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
    moment_.pose.move_to(time(frame));
    for (const auto& [node, track] : weights_) {
      std::vector<double>& weights = moment_.weights[node];
      weights.resize(track.columns());
      track.sample(time(frame), weights);
    }
    for (const auto& [skin, joints] : skins_) moment_.joints[skin] = joints.to_scene(moment_.pose);
    positions = rest_;
    for (const auto& [first_vertex, part] : parts_)
      part.place(moment_, std::span(positions).subspan(first_vertex, part.size()));
  }

 private:
  [[noreturn]] static void throw_without_change() {
    throw Error("the animation does not change any mesh of the scene");
  }

  // Frames are at the keys of all tracks, or in equal steps from the first key to the last.
  void choose_times(std::optional<double> rate) {
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

  // Adds what moves of an instance, whose vertices follow those of the instances before it.
  void add_instance(const GltfDocument& document, const GltfInstance& instance) {
    const GltfJoints* joints = instance.skin ? &joints_of(document, *instance.skin) : nullptr;
    const auto carrier = joints ? carrier_of(*joints) : moment_.pose.carrier(instance.node);
    std::optional<std::vector<double>> fixed_weights;
    if (!weights_.contains(instance.node)) fixed_weights = gltf_weights(document, instance);
    std::size_t next_vertex = polygons_.bodies.size();
    for (const json& primitive : list_of(document.item("meshes", instance.mesh), "primitives")) {
      if (!has_triangles(document, primitive)) continue;
      if (carrier || !fixed_weights)
        parts_.emplace_back(next_vertex, GltfMovingPart(document, instance, primitive, fixed_weights,
                                                        joints ? joints->nodes.size() : 0));
      next_vertex += document.count(whole_number(primitive.at("attributes"), "POSITION"));
    }
    // What different nodes carry may part, and so may two meshes with a skin.
    const std::size_t body = !carrier ? 0 : joints ? 1 + 2 * instance.node : 2 + 2 * *carrier;
    polygons_.bodies.resize(next_vertex, static_cast<std::uint32_t>(body));
  }

  const GltfJoints& joints_of(const GltfDocument& document, std::size_t skin) {
    if (const auto known = skins_.find(skin); known != skins_.end()) return known->second;
    return skins_.emplace(skin, gltf_joints(document, moment_.pose, skin)).first->second;
  }
  // A node that carries a joint, if any moves.
  std::optional<std::size_t> carrier_of(const GltfJoints& joints) const {
    for (const std::size_t node : joints.nodes)
      if (const auto carrier = moment_.pose.carrier(node)) return carrier;
    return {};
  }

  std::filesystem::path file_;
  std::vector<double> key_times_;
  GltfMoment moment_;
  std::map<std::size_t, GltfTrack> weights_;                   // by node
  std::map<std::size_t, GltfJoints> skins_;                    // those that are used
  std::vector<std::pair<std::size_t, GltfMovingPart>> parts_;  // with their first vertices
  PolygonMesh polygons_;
  std::vector<Vec3> rest_;  // of what does not move; the rest is overwritten
  double interval_ = 0;
  std::size_t count_ = 0;
};

}  // namespace

std::unique_ptr<FrameSource> gltf_frames(std::string_view bytes, const std::filesystem::path& file,
                                         std::optional<double> rate) {
  try {
    const GltfDocument document(bytes, file.parent_path());
    if (list_of(document.root(), "animations").empty()) return nullptr;
    return std::make_unique<GltfFrames>(document, gltf_animation(document), file, rate);
  } catch (const json::exception& fault) {
    throw_gltf_fault(fault);
  }
}

}  // namespace sdm::io
