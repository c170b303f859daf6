#include "io/page/player/animated_model.h"

#include <sdm/mesh_attributes.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "geometry/vec.h"
#include "io/file/atomic_file.h"
#include "io/image/pictures/color_scale.h"
#include "io/mesh/model/glb_model.h"

namespace sdm::io {
namespace {

// Viewers keep morph targets as layers of a texture, of which WebGL 2 has 256 at least.
constexpr std::size_t kMostFrames = 250;
constexpr std::size_t kMostMorphNumbers = 12'000'000;  // floats of all morph targets

constexpr std::array<float, 3> kPlain{0.46f, 0.5f, 0.55f};  // linear, of a body without colours

/// glTF's vertex colours are linear.
float linear(std::uint8_t value) {
  return linear_light(static_cast<float>(value) / 255);
}

struct Frames {
  std::vector<const PlayerFrame*> shown;
  std::vector<float> seconds;  ///< of each
};

/// One of `step` frames, so that the model is of bounded size; the last one is among them if step is 1.
Frames chosen(const PlayerContent& content, double per_second) {
  std::size_t numbers = 1;  // of a frame
  for (int b = 0; b < 2; ++b)
    numbers += 3 * content.frames[0].positions[b].size() + 3 * content.frames[0].distances[b].size();
  const std::size_t most = std::clamp<std::size_t>(kMostMorphNumbers / numbers, 2, kMostFrames);
  const std::size_t step = (content.frames.size() + most - 1) / most;
  Frames frames;
  for (std::size_t i = 0; i < content.frames.size(); i += step) {
    const PlayerFrame& frame = content.frames[i];
    frames.shown.push_back(&frame);
    const std::size_t number = content.added[frame.number] - content.added[0];
    frames.seconds.push_back(static_cast<float>(static_cast<double>(number) / per_second));
  }
  return frames;
}

class Writer {
 public:
  Writer(const PlayerContent& content, const PlayerOptions& options, const PictureOptions& fixed)
      : content_(content), frames_(chosen(content, options.frames_per_second)), scale_(color_scale(fixed)) {
    Box box;
    for (const PlayerFrame* frame : frames_.shown)
      for (const auto& positions : frame->positions)
        for (const Vec3f& p : positions) extend(box, Vec3{p[0], p[1], p[2]});
    place_ = placement(box, options.units);
    std::vector<tinygltf::Node> nodes;
    for (int b = 0; b < 2; ++b) {
      add_body(b, options.names[b]);
      nodes.push_back(placed_node(place_, options.up));
      nodes.back().name = options.names[b];
      nodes.back().mesh = b;
    }
    glb_.add_scene(nodes);
    add_animation();
  }

  [[nodiscard]] const tinygltf::Model& model() const { return glb_.model; }
  [[nodiscard]] std::size_t frames() const { return frames_.shown.size(); }

 private:
  using Triple = std::array<float, 3>;

  int add_material(bool coloured) {
    tinygltf::Material material;
    material.name = coloured ? "distance" : "plain";
    material.doubleSided = true;
    material.pbrMetallicRoughness.metallicFactor = 0;
    material.pbrMetallicRoughness.roughnessFactor = 1;
    if (!coloured) material.pbrMetallicRoughness.baseColorFactor = {kPlain[0], kPlain[1], kPlain[2], 1};
    glb_.model.materials.push_back(material);
    return static_cast<int>(glb_.model.materials.size()) - 1;
  }

  [[nodiscard]] Triple position(std::size_t frame, int body, std::size_t vertex) const {
    const Vec3f& p = frames_.shown[frame]->positions[body][vertex];
    Triple result;
    for (int k = 0; k < 3; ++k) result[k] = static_cast<float>(p[k] - place_.origin[k]);
    return result;
  }
  [[nodiscard]] Triple color(std::size_t frame, int body, std::size_t vertex) const {
    const float d = frames_.shown[frame]->distances[body][vertex];
    const Rgb rgb = std::isfinite(d) ? scale_(d) : kNoValue;
    return {linear(rgb.r), linear(rgb.g), linear(rgb.b)};
  }

  /// Adds triples with their bounds.
  template <class At>
  int add_triples(std::size_t count, const At& at) {
    const int accessor =
        glb_.add_accessor<Triple>(count, TINYGLTF_TYPE_VEC3, TINYGLTF_COMPONENT_TYPE_FLOAT,
                                  TINYGLTF_TARGET_ARRAY_BUFFER, [&](std::size_t i, Triple& t) { t = at(i); });
    Triple lo, hi;
    lo.fill(std::numeric_limits<float>::infinity());
    hi.fill(-lo[0]);
    for (std::size_t i = 0; i < count; ++i) {
      const Triple t = at(i);
      for (int k = 0; k < 3; ++k) {
        lo[k] = std::min(lo[k], t[k]);
        hi[k] = std::max(hi[k], t[k]);
      }
    }
    glb_.model.accessors[accessor].minValues.assign(lo.begin(), lo.end());
    glb_.model.accessors[accessor].maxValues.assign(hi.begin(), hi.end());
    return accessor;
  }

  /// Triples without bytes in the file, which are 0.
  int add_zeros(std::size_t count) {
    tinygltf::Accessor accessor;
    accessor.componentType = TINYGLTF_COMPONENT_TYPE_FLOAT;
    accessor.type = TINYGLTF_TYPE_VEC3;
    accessor.count = count;
    accessor.minValues = accessor.maxValues = {0, 0, 0};
    glb_.model.accessors.push_back(accessor);
    return static_cast<int>(glb_.model.accessors.size()) - 1;
  }

  void add_body(int body, const std::string& name) {
    const auto triangles = content_.triangles[body];
    const std::size_t vertices = frames_.shown[0]->positions[body].size();
    const bool coloured = !frames_.shown[0]->distances[body].empty();
    const bool moves = std::ranges::any_of(frames_.shown, [&](const PlayerFrame* frame) {
      return frame->positions[body] != frames_.shown[0]->positions[body];
    });
    tinygltf::Mesh& mesh = glb_.model.meshes.emplace_back();
    mesh.name = name;
    tinygltf::Primitive& primitive = mesh.primitives.emplace_back();
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.material = add_material(coloured);
    primitive.indices = glb_.add_accessor<Triangle>(
        triangles.size(), TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
        TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER, [&](std::size_t i, Triangle& t) { t = triangles[i]; });
    // No normals: viewers then shade faces as they are in each frame.
    primitive.attributes["POSITION"] =
        add_triples(vertices, [&](std::size_t i) { return position(0, body, i); });
    if (coloured)
      primitive.attributes["COLOR_0"] =
          add_triples(vertices, [&](std::size_t i) { return color(0, body, i); });
    animated_[body] = moves || coloured;
    if (!animated_[body]) return;
    const auto difference = [](const Triple& a, const Triple& b) {
      return Triple{a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    };
    // three.js reads the positions of every target: those of a body at rest are one accessor of zeros.
    const int zeros = !moves && frames() > 1 ? add_zeros(vertices) : -1;
    for (std::size_t frame = 1; frame < frames(); ++frame) {
      std::map<std::string, int>& target = primitive.targets.emplace_back();
      if (!moves)
        target["POSITION"] = zeros;
      else
        target["POSITION"] = add_triples(vertices, [&](std::size_t i) {
          return difference(position(frame, body, i), position(0, body, i));
        });
      if (coloured)
        target["COLOR_0"] = add_triples(
            vertices, [&](std::size_t i) { return difference(color(frame, body, i), color(0, body, i)); });
    }
  }

  /// Frame i has the weight 1 of its target and 0 of all others; between frames both are linear.
  void add_animation() {
    const std::size_t targets = frames() - 1;
    if (targets == 0 || (!animated_[0] && !animated_[1])) return;
    tinygltf::Animation animation;
    animation.name = "frames";
    tinygltf::AnimationSampler sampler;
    sampler.interpolation = "LINEAR";
    const auto floats = [&](std::size_t count, const auto& at) {
      return glb_.add_accessor<float>(count, TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_FLOAT, 0,
                                      [&](std::size_t i, float& x) { x = at(i); });
    };
    sampler.input = floats(frames(), [&](std::size_t i) { return frames_.seconds[i]; });
    glb_.model.accessors[sampler.input].minValues = {frames_.seconds.front()};
    glb_.model.accessors[sampler.input].maxValues = {frames_.seconds.back()};
    sampler.output =
        floats(frames() * targets, [&](std::size_t i) { return i / targets == i % targets + 1 ? 1.f : 0.f; });
    animation.samplers.push_back(sampler);
    for (int body = 0; body < 2; ++body) {
      if (!animated_[body]) continue;
      tinygltf::AnimationChannel channel;
      channel.sampler = 0;
      channel.target_node = body;
      channel.target_path = "weights";
      animation.channels.push_back(channel);
    }
    glb_.model.animations.push_back(animation);
  }

  const PlayerContent& content_;
  Frames frames_;
  ColorScale scale_;
  Placement place_;
  GlbModel glb_;
  std::array<bool, 2> animated_{};
};

}  // namespace

std::size_t write_animated_model(const std::filesystem::path& file, const PlayerContent& content,
                                 const PlayerOptions& options, const PictureOptions& fixed) {
  AtomicFile out(file);
  const Writer writer(content, options, fixed);
  tinygltf::TinyGLTF().WriteGltfSceneToStream(&writer.model(), out.stream(), false, true);
  out.commit();
  return writer.frames();
}

}  // namespace sdm::io
