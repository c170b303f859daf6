#include "module/looks.h"

#include <sdm/error.h>
#include <sdm/mesh_files.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "io/mesh/mesh_file.h"
#include "io/mesh/read_polygons.h"
#include "module/given_files.h"
#include "module/result.h"

namespace sdm::js {
namespace {

/// Sites have no texture coordinates, so that those of the mesh become an attribute.
MeshAttribute uv_attribute(const Mesh& mesh) {
  MeshAttribute uvs{.name = "uv0", .components = 2, .values = {}, .rows = nullptr};
  std::vector<Triangle> rows;
  rows.reserve(mesh.corner_uvs.size());
  uvs.values.reserve(6 * mesh.corner_uvs.size());
  for (std::uint32_t row = 0; const auto& corners : mesh.corner_uvs) {
    rows.push_back({row, row + 1, row + 2});
    row += 3;
    for (const Vec2& uv : corners)
      for (const double x : uv) uvs.values.push_back(static_cast<float>(x));
  }
  uvs.rows = std::make_shared<const std::vector<Triangle>>(std::move(rows));
  return uvs;
}

Look look_of(MeshFile file) {
  Look look{.materials = std::move(file.materials),
            .face_materials = std::move(file.face_materials),
            .pictures = std::vector<Image>(file.textures.size()),
            .textures = std::move(file.textures),
            .attributes = std::move(file.attributes)};
  if (!file.mesh.corner_uvs.empty()) look.attributes.push_back(uv_attribute(file.mesh));
  return look;
}

}  // namespace

const MeshAttribute* Look::normals() const {
  const auto found = std::ranges::find(attributes, "normal", &MeshAttribute::name);
  return found == attributes.end() ? nullptr : &*found;
}

/// The look, whether the file has materials, colours and normals, and JSON with the names of its textures and
/// what was left out.
SDM_EXPORT(sdm_read_look)
Result* read_look(const char* bytes, std::uint32_t size, const char* name, std::uint32_t name_size,
                  const char* names, const char* contents, const std::uint32_t* lengths,
                  std::uint32_t files) {
  return guarded([&](Result& result) {
    MeshFile file =
        with_given_files({bytes, size, name, name_size, names, contents, lengths, files},
                         [](std::string_view content, const std::string& path) {
                           return io::to_mesh_file(io::read_polygons(content, path, {.attributes = true}),
                                                   {.attributes = true});
                         });
    nlohmann::ordered_json facts{{"textures", nlohmann::json::array()}, {"notes", file.notes}};
    for (const TextureFile& texture : file.textures) facts["textures"].push_back(texture.name);
    auto look = std::make_unique<Look>(look_of(std::move(file)));
    result.put("has_materials", !look->materials.empty());
    result.put("has_colors", std::ranges::count(look->attributes, "color", &MeshAttribute::name) > 0);
    result.put("has_normals", look->normals() != nullptr);
    result.put_object(std::move(look));
    result.put_text("facts", facts.dump(-1, ' ', false, nlohmann::json::error_handler_t::ignore));
  });
}

SDM_EXPORT(sdm_free_look) void free_look(Look* look) {
  delete look;
}

/// The file of a texture, in PNG, JPEG or WebP.
SDM_EXPORT(sdm_texture_file) Result* texture_file(const Look* look, std::uint32_t texture) {
  return guarded([&](Result& result) {
    if (texture >= look->textures.size()) throw Error("there is no texture of this number");
    result.put("bytes", look->textures[texture].bytes);
  });
}

/// The pixels of a texture, four numbers each, row after row from the top.
SDM_EXPORT(sdm_set_picture)
Result* set_picture(Look* look, std::uint32_t texture, std::uint32_t width, std::uint32_t height,
                    const std::uint8_t* pixels, std::uint32_t bytes) {
  return guarded([&](Result&) {
    if (texture >= look->pictures.size()) throw Error("there is no texture of this number");
    constexpr std::uint32_t kComponents = 4;
    if (std::uint64_t{kComponents} * width * height != bytes)
      throw Error("a picture needs four numbers for each of its pixels");
    look->pictures[texture] = {.width = width,
                               .height = height,
                               .components = kComponents,
                               .bits = 8,
                               .bytes = {pixels, pixels + bytes}};
  });
}

}  // namespace sdm::js
