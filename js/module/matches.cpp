// The points of O2 that belong to the texels of a surface, and what O2 has there.
#include <sdm/bake.h>
#include <sdm/baked_geometry.h>
#include <sdm/error.h>
#include <sdm/match.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <utility>

#include "geometry/vec.h"
#include "io/mesh/model/model_vertices.h"
#include "module/arguments.h"
#include "module/looks.h"
#include "module/options.h"
#include "module/result.h"
#include "module/transferred.h"

namespace sdm::js {
namespace {

/// The normals of a file, turned as its mesh was. `rotation`: rows of a matrix.
MeshAttribute turned_normals(const MeshAttribute& normals, const double* rotation) {
  MeshAttribute turned = normals;
  for (std::size_t i = 0; i + 2 < normals.values.size(); i += 3)
    for (std::size_t k = 0; k < 3; ++k) {
      double sum = 0;
      for (std::size_t j = 0; j < 3; ++j) sum += rotation[3 * k + j] * normals.values[i + j];
      turned.values[i + k] = static_cast<float>(sum);
    }
  return turned;
}

/// What a surface is drawn with, for normals in its tangent space.
struct Frames {
  MeshAttribute normals, tangents;

  explicit Frames(const Surface& surface)
      : normals(smooth_normals(surface.mesh(), kDrawnCrease)), tangents(sdm::tangents(surface, normals)) {}
};

}  // namespace

/// Matches, and how many texels have a point by the kinds of MatchKind.
SDM_EXPORT(sdm_match)
Result* match(const Surface* surface, const Sites* sites, const char* lines, std::uint32_t bytes,
              const double* numbers) {
  return guarded([&](Result& result) {
    auto options = read_options<MatchOptions>({lines, bytes, numbers});
    options.progress = host_progress();
    auto matches = std::make_unique<TexelMatches>(match_texels(*surface, *sites, options));
    const auto count = [&](MatchKind kind) { return matches->count(kind); };
    const std::array counts{count(MatchKind::closest), count(MatchKind::facing), count(MatchKind::ray),
                            count(MatchKind::too_far), count(MatchKind::facing_away)};
    const std::uint32_t resolution = matches->resolution, rows = matches->rows();
    result.add_object(std::move(matches));
    result.add_numbers(resolution, rows, counts[0], counts[1], counts[2], counts[3], counts[4]);
  });
}

SDM_EXPORT(sdm_free_matches) void free_matches(TexelMatches* matches) {
  delete matches;
}

/// The kind of each texel, a byte each, its face, and the shares of the face's second and third corners.
SDM_EXPORT(sdm_match_arrays) Result* match_arrays(const TexelMatches* matches) {
  return guarded([&](Result& result) {
    std::vector<std::uint8_t> kinds;
    kinds.reserve(matches->kind.size());
    for (const MatchKind kind : matches->kind) kinds.push_back(static_cast<std::uint8_t>(kind));
    result.add(std::move(kinds));
    result.add(matches->face);
    result.add(matches->barycentric);
  });
}

SDM_EXPORT(sdm_transfer_matches)
Result* transfer_matches(const Surface* surface, const Sites* sites, const TexelMatches* matches,
                         const float* values, std::uint32_t count, std::uint32_t components,
                         std::uint32_t domain, bool fill) {
  return transferred(surface, sites, matches, values, count, components, domain, fill);
}

/// Of each channel of default_channels() its number and how many components its picture has, the factors of
/// common_material() (base colour, emission, metallic, roughness, mode and cutoff of alpha), and the pictures
/// of to_image(). Texels without a match are filled.
SDM_EXPORT(sdm_bake)
Result* bake_look(const Surface* surface, const Sites* sites, const TexelMatches* matches, const Look* look) {
  return guarded([&](Result& result) {
    const MeshLook view = look->view();
    const Material m = common_material(view);
    const auto baked = bake(*surface, *sites, *matches, view, default_channels(sites->mesh(), view),
                            {.fill = true, .progress = host_progress()});
    std::vector<std::uint32_t> channels;
    std::vector<std::vector<std::uint8_t>> pictures;
    for (const BakedChannel& channel : baked) {
      Image image = to_image(channel);
      channels.push_back(static_cast<std::uint32_t>(channel.channel));
      channels.push_back(image.components);
      pictures.push_back(std::move(image.bytes));
    }
    result.add(std::move(channels));
    result.add_numbers(m.base_color[0], m.base_color[1], m.base_color[2], m.base_color[3], m.emissive[0],
                       m.emissive[1], m.emissive[2], m.metallic, m.roughness, static_cast<int>(m.alpha_mode),
                       m.alpha_cutoff);
    for (auto& picture : pictures) result.add(std::move(picture));
  });
}

/// A picture of the normals of O2, red, green and blue: those of `look` if it is given and has some, turned
/// by `rotation`, rows of a matrix, otherwise smooth ones of the mesh. `tangent_space`: as glTF has it, for
/// sdm_drawn_model() with tangents; otherwise in the coordinates of the meshes. Texels without a match are
/// filled.
SDM_EXPORT(sdm_bake_normals)
Result* bake_normals(const Surface* surface, const Sites* sites, const TexelMatches* matches,
                     const Look* look, const double* rotation, bool tangent_space) {
  return guarded([&](Result& result) {
    const MeshAttribute* const own = look == nullptr ? nullptr : look->normals();
    const MeshAttribute normals =
        own == nullptr ? smooth_normals(sites->mesh(), kDrawnCrease) : turned_normals(*own, rotation);
    std::vector<float> values = matched_normals(*surface, *sites, *matches, normals, host_progress());
    if (tangent_space) {
      const Frames frames(*surface);
      values = tangent_space_normals(*surface, frames.normals, frames.tangents, values, host_progress());
    }
    fill_texels(*surface, 3, values, true);
    result.add(normal_map_image(*surface, values).bytes);
  });
}

/// The vertices that a model of the surface is drawn with: positions relative to a point, normals, texture
/// coordinates from 0 to 1 with v down, tangents (nothing unless they are wanted), triangles, and that point.
SDM_EXPORT(sdm_drawn_model) Result* drawn_model(const Surface* surface, bool with_tangents) {
  return guarded([&](Result& result) {
    const Mesh& mesh = surface->mesh();
    const auto frames = with_tangents ? std::optional<Frames>(*surface) : std::nullopt;
    const io::ShadingNormals normals =
        frames ? mesh::sheet_normals(mesh, frames->normals) : io::shading_normals(mesh);
    io::ModelVertices vertices =
        io::model_vertices(*surface, normals, io::drawn_faces(mesh), frames ? &frames->tangents : nullptr);
    const Box box = bounds(mesh);
    const Vec3 origin = 0.5 * (box.lo + box.hi);
    const Vec2 extent{1.0 * surface->resolution(), 1.0 * surface->rows()};
    const auto add = [&](std::size_t components, const auto& value) {
      std::vector<float> values(components * vertices.place.size());
      for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = static_cast<float>(value(i / components, i % components));
      result.add(std::move(values));
    };
    const auto vertex = [&](std::size_t i) { return normals.vertex[vertices.normal[i]]; };
    add(3, [&](std::size_t i, std::size_t k) { return mesh.positions[vertex(i)][k] - origin[k]; });
    add(3, [&](std::size_t i, std::size_t k) { return normals.normals[vertices.normal[i]][k]; });
    add(2,
        [&](std::size_t i, std::size_t k) { return std::clamp(vertices.place[i][k] / extent[k], 0.0, 1.0); });
    add(frames ? 4 : 0, [&](std::size_t i, std::size_t k) {
      return frames->tangents.values[4 * std::size_t{vertices.tangent[i]} + k];
    });
    result.add(std::move(vertices.triangles));
    result.add_numbers(origin[0], origin[1], origin[2]);
  });
}

/// Whether there are tangents, and so normals in tangent space.
SDM_EXPORT(sdm_has_tangents) std::uint32_t has_tangents_here() {
  return has_tangents();
}

}  // namespace sdm::js
