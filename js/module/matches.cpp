// The points of O2 that belong to the texels of a surface, and what O2 has there.
#include <sdm/bake.h>
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

SDM_EXPORT(sdm_match)
Result* match(const Surface* surface, const Sites* sites, const char* lines, std::uint32_t bytes,
              const double* numbers) {
  return guarded([&](Result& result) {
    auto options = read_options<MatchOptions>({lines, bytes, numbers});
    options.progress = host_progress();
    auto matches = std::make_unique<TexelMatches>(match_texels(*surface, *sites, options));
    result.put("resolution", matches->resolution);
    result.put("rows", matches->rows());
    result.put_fields("counts/", matches->counts());
    result.put_object(std::move(matches));
  });
}

SDM_EXPORT(sdm_free_matches) void free_matches(TexelMatches* matches) {
  delete matches;
}

/// Barycentric coordinates are the shares of the face's second and third corners.
SDM_EXPORT(sdm_match_arrays) Result* match_arrays(const TexelMatches* matches) {
  return guarded([&](Result& result) {
    result.put("kinds", matches->kind);
    result.put("faces", matches->face);
    result.put("barycentric", matches->barycentric);
  });
}

SDM_EXPORT(sdm_transfer_matches)
Result* transfer_matches(const Surface* surface, const Sites* sites, const TexelMatches* matches,
                         const float* values, std::uint32_t count, const char* lines, std::uint32_t bytes,
                         const double* numbers) {
  return transferred(surface, sites, matches, {values, count}, {lines, bytes, numbers});
}

/// The pictures of default_channels(), and the factors of common_material(). Texels without a match are
/// filled.
SDM_EXPORT(sdm_bake)
Result* bake_look(const Surface* surface, const Sites* sites, const TexelMatches* matches, const Look* look) {
  return guarded([&](Result& result) {
    const MeshLook view = look->view();
    const Material m = common_material(view);
    const auto baked = bake(*surface, *sites, *matches, view, default_channels(sites->mesh(), view),
                            {.fill = true, .progress = host_progress()});
    for (std::size_t i = 0; i < baked.size(); ++i) {
      Image image = to_image(baked[i]);
      const std::string path = "textures/" + std::to_string(i) + "/";
      result.put(path + "channel", name_of(baked[i].channel));
      result.put(path + "components", image.components);
      result.put(path + "data", std::move(image.bytes));
    }
    result.put("material/base_color", m.base_color);
    result.put("material/emissive", m.emissive);
    result.put("material/metallic", m.metallic);
    result.put("material/roughness", m.roughness);
    result.put("material/alpha_mode", m.alpha_mode);
    result.put("material/alpha_cutoff", m.alpha_cutoff);
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
    result.put("picture", normal_map_image(*surface, values).bytes);
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
    const Vec3 origin = 0.5 * (box.lower + box.upper);
    const Vec2 extent{1.0 * surface->resolution(), 1.0 * surface->rows()};
    const auto put = [&](const char* name, std::size_t components, const auto& value) {
      std::vector<float> values(components * vertices.place.size());
      for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = static_cast<float>(value(i / components, i % components));
      result.put(name, std::move(values));
    };
    const auto vertex = [&](std::size_t i) { return normals.vertex[vertices.normal[i]]; };
    put("positions", 3,
        [&](std::size_t i, std::size_t k) { return mesh.positions[vertex(i)][k] - origin[k]; });
    put("normals", 3, [&](std::size_t i, std::size_t k) { return normals.normals[vertices.normal[i]][k]; });
    put("uvs", 2,
        [&](std::size_t i, std::size_t k) { return std::clamp(vertices.place[i][k] / extent[k], 0.0, 1.0); });
    if (frames)
      put("tangents", 4, [&](std::size_t i, std::size_t k) {
        return frames->tangents.values[4 * std::size_t{vertices.tangent[i]} + k];
      });
    else
      result.put("tangents", std::optional<double>());
    result.put("indices", std::move(vertices.triangles));
    result.put("origin", origin);
  });
}

}  // namespace sdm::js
