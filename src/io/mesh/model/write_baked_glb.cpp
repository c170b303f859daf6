#include <sdm/bake_files.h>
#include <sdm/error.h>
#include <sdm/mesh_edit.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <new>
#include <string>

#include "core/memory.h"
#include "io/file/atomic_file.h"
#include "io/mesh/model/drawn_surface.h"
#include "io/mesh/model/gltf_material.h"

namespace sdm {

using namespace io;

namespace {

// A texture contains its factor.
void set_texture(tinygltf::Material& material, BakeChannel channel, int texture) {
  tinygltf::PbrMetallicRoughness& surface = material.pbrMetallicRoughness;
  switch (channel) {
    case BakeChannel::base_color:
      surface.baseColorTexture.index = texture;
      surface.baseColorFactor.assign(4, 1);
      break;
    case BakeChannel::metallic_roughness:
      surface.metallicRoughnessTexture.index = texture;
      surface.metallicFactor = surface.roughnessFactor = 1;
      break;
    case BakeChannel::occlusion:
      material.occlusionTexture.index = texture;
      break;
    case BakeChannel::emissive:
      material.emissiveTexture.index = texture;
      material.emissiveFactor.assign(3, 1);
      break;
  }
}

/// Throws sdm::Error unless each corner of a face has a row of that many numbers.
void require_rows(const Mesh& mesh, const MeshAttribute& attribute, std::size_t components) {
  const std::size_t rows = attribute.values.size() / components;
  bool fits =
      attribute.components == components && attribute.rows && attribute.rows->size() == mesh.triangles.size();
  for (std::size_t face = 0; fits && face < mesh.triangles.size(); ++face)
    if (!is_removed(mesh.triangles[face]))
      fits = std::ranges::all_of((*attribute.rows)[face], [&](std::uint32_t row) { return row < rows; });
  if (!fits)
    throw Error("the normals and tangents of a model need " + std::to_string(components) +
                " numbers for each corner of its faces");
}

void require_fitting(const Mesh& mesh, const BakedModelOptions& options) {
  if (options.normals != nullptr) require_rows(mesh, *options.normals, 3);
  if (options.tangents != nullptr) require_rows(mesh, *options.tangents, 4);
  if (options.normal_map.empty() != (options.tangents == nullptr))
    throw Error("a normal map needs the tangents that it was made with");
}

}  // namespace

void write_baked_glb(const std::filesystem::path& file, const Surface& surface,
                     std::span<const BakedTexture> textures, const BakedModelOptions& options) try {
  AtomicFile out(file);
  const Mesh& mesh = surface.mesh();
  require_fitting(mesh, options);
  const ShadingNormals normals =
      options.normals != nullptr ? mesh::sheet_normals(mesh, *options.normals) : shading_normals(mesh);
  const ModelVertices vertices = model_vertices(surface, normals, drawn_faces(mesh), options.tangents);
  const DrawnSurface drawn{.mesh = mesh,
                           .normals = normals,
                           .place = placement(bounds(mesh), options.units),
                           .extent = {1.0 * surface.resolution(), 1.0 * surface.rows()},
                           .tangents = options.tangents};
  GlbModel glb;
  glb.model.meshes.emplace_back().name = "O1";
  std::size_t bytes = bytes_of(vertices) + options.normal_map.size();
  for (const BakedTexture& texture : textures) bytes += texture.png.size();
  glb.reserve(bytes);
  glb.model.meshes[0].primitives.push_back(primitive_of(glb, drawn, vertices));
  tinygltf::Material material = factors_of(options.material);
  material.name = "baked";
  for (const BakedTexture& texture : textures)
    set_texture(material, texture.channel,
                add_png(glb, texture.png, TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_LINEAR));
  if (!options.normal_map.empty())
    material.normalTexture.index =
        add_png(glb, options.normal_map, TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_LINEAR);
  glb.model.materials.push_back(material);
  glb.add_scene({drawn_node(drawn.place, options.up)});
  tinygltf::TinyGLTF().WriteGltfSceneToStream(&glb.model, out.stream(), false, true);
  out.commit();
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

}  // namespace sdm
