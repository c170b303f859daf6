// Animations of mesh files.
#include <sdm/error.h>

#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "io/mesh/frames/welded_frames.h"
#include "io/mesh/read_polygons.h"
#include "module/given_files.h"
#include "module/result.h"

namespace sdm::js {
namespace {

struct Animation {
  std::unique_ptr<io::FrameSource> source;
  std::optional<io::WeldedFrames> frames;
};

/// Null if the file has no animation.
std::unique_ptr<Animation> animation_of(const FileArguments& file, double rate) {
  return with_given_files(file, [&](std::string_view bytes, const std::string& path) {
    std::unique_ptr<Animation> animation;
    if (!io::is_gltf(bytes, path)) return animation;
    auto source = io::gltf_frames(bytes, path, std::isnan(rate) ? std::nullopt : std::optional(rate));
    if (!source) return animation;
    animation = std::make_unique<Animation>();
    animation->source = std::move(source);
    animation->frames.emplace(*animation->source, animation->source->take_polygons());
    animation->frames->begin();
    return animation;
  });
}

std::vector<Vec3> copy(std::span<const Vec3> positions) {
  return {positions.begin(), positions.end()};
}

}  // namespace

/// The animation, if there is one, and its first frame. `rate`: frames per second; NaN: those of the keys.
SDM_EXPORT(sdm_read_animation)
Result* read_animation(const char* bytes, std::uint32_t size, const char* name, std::uint32_t name_size,
                       const char* names, const char* contents, const std::uint32_t* lengths,
                       std::uint32_t files, double rate) {
  return guarded([&](Result& result) {
    if (rate <= 0 || std::isinf(rate))
      throw Error("the rate of an animation must be a number of frames per second greater than 0");
    auto animation = animation_of({bytes, size, name, name_size, names, contents, lengths, files}, rate);
    if (!animation) return;
    const Mesh& mesh = animation->frames->mesh();
    result.put("frames", animation->source->count());
    result.put("positions", mesh.positions);
    result.put("indices", mesh.triangles);
    result.put_object(std::move(animation));
  });
}

SDM_EXPORT(sdm_free_animation) void free_animation(Animation* animation) {
  delete animation;
}

SDM_EXPORT(sdm_animation_frame) Result* animation_frame(Animation* animation, std::uint32_t frame) {
  return guarded([&](Result& result) {
    if (frame >= animation->source->count()) throw Error("the animation has no frame of this number");
    result.put("positions", copy(animation->frames->read(frame)));
  });
}

}  // namespace sdm::js
