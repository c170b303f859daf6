#include "atlas/gutter.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/vec.h"
#include "io/file/atomic_file.h"
#include "io/image/pictures/atlas_picture.h"
#include "io/image/pictures/color_scale.h"
#include "io/image/pictures/face_scales.h"
#include "io/image/pictures/png.h"
#include "io/mesh/model/glb_model.h"
#include "io/mesh/model/model_vertices.h"
#include "io/mesh/model/shading_normals.h"

#include <sdm/error.h>
#include <sdm/io.h>
#include <sdm/threads.h>
#include <sdm/version.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace sdm {

using namespace io;

namespace {

/// What the primitives have in common.
struct Model {
  const Mesh& mesh;
  const ShadingNormals& normals;
  Placement place;
  Vec2 extent;  ///< the width and height of the texture, in texels of the atlas
  std::span<const float> vertex_distances;
};

void add_primitive(GlbModel& glb, const Model& model, const ModelVertices& vertices, bool with_distances) {
  if (vertices.triangles.empty()) return;
  const std::size_t count = vertices.place.size();
  const auto vertex = [&](std::size_t i) { return model.normals.vertex[vertices.normal[i]]; };
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.material = 0;
  primitive.indices = glb.add_accessor<Triangle>(
      vertices.triangles.size(), TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
      TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER, [&](std::size_t i, Triangle& t) { t = vertices.triangles[i]; });
  const auto add_attribute = [&]<class Element>(const char* name, int type, Element /*kind*/,
                                                const auto& fill) {
    return primitive.attributes[name] = glb.add_accessor<Element>(count, type, TINYGLTF_COMPONENT_TYPE_FLOAT,
                                                                  TINYGLTF_TARGET_ARRAY_BUFFER, fill);
  };
  const auto position = [&](std::size_t i, Vec3f& q) {
    const Vec3 p = model.mesh.positions[vertex(i)] - model.place.origin;
    for (int k = 0; k < 3; ++k) q[k] = static_cast<float>(p[k]);
  };
  auto& accessor = glb.model.accessors[add_attribute("POSITION", TINYGLTF_TYPE_VEC3, Vec3f{}, position)];
  Vec3f lo, hi, q;
  lo.fill(std::numeric_limits<float>::infinity()), hi.fill(-std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < count; ++i) {
    position(i, q);
    for (int k = 0; k < 3; ++k) lo[k] = std::min(lo[k], q[k]), hi[k] = std::max(hi[k], q[k]);
  }
  accessor.minValues.assign(lo.begin(), lo.end());
  accessor.maxValues.assign(hi.begin(), hi.end());
  add_attribute("NORMAL", TINYGLTF_TYPE_VEC3, Vec3f{},
                [&](std::size_t i, Vec3f& n) { n = model.normals.normals[vertices.normal[i]]; });
  add_attribute("TEXCOORD_0", TINYGLTF_TYPE_VEC2, std::array<float, 2>{},  // in [0, 1], v down
                [&](std::size_t i, std::array<float, 2>& uv) {
                  for (int k = 0; k < 2; ++k)
                    uv[k] = static_cast<float>(std::clamp(vertices.place[i][k] / model.extent[k], 0.0, 1.0));
                });
  if (with_distances)
    add_attribute("_DISTANCE", TINYGLTF_TYPE_SCALAR, 0.0f,
                  [&](std::size_t i, float& d) { d = model.vertex_distances[vertex(i)]; });
  glb.model.meshes[0].primitives.push_back(primitive);
}

/// The coloured map with its gutters filled. Corners of charts extend beyond the texels that the chart owns,
/// and small charts own hardly any: the free texels that are blended at a vertex get the vertex's own
/// distance.
std::string texture_png(const Surface& surface, const DistanceMap& map, const FaceScales& scales,
                        const AtlasPicture& picture, std::span<const float> vertex_distances) {
  const std::uint32_t n = picture.width(), rows = picture.height();
  const Mesh& mesh = surface.mesh();
  std::vector<std::uint32_t> shown(std::size_t{n} * rows);  // texels
  std::vector<float> distance(shown.size());
  std::vector<std::uint32_t> owner(scales.by_group() ? shown.size() : 0, kNone);  // the face of each pixel
  parallel_for(rows, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t pixel = begin * n; pixel < end * n; ++pixel) {
      shown[pixel] =
          picture.texel(static_cast<std::uint32_t>(pixel % n), static_cast<std::uint32_t>(pixel / n));
      if (shown[pixel] == kNone) continue;
      distance[pixel] = map.distance[shown[pixel]];
      if (!owner.empty()) owner[pixel] = surface.texel_faces()[shown[pixel]];
    }
  });
  // Free pixels beside corners, found in parallel, are filled in the order of the faces.
  struct Seed {
    std::size_t pixel;
    float distance;
    std::uint32_t face;
  };
  constexpr std::size_t kFaces = 1 << 15;
  std::vector<std::vector<Seed>> seeds((mesh.triangles.size() + kFaces - 1) / kFaces);
  parallel_for(seeds.size(), 1, [&](std::size_t begin, std::size_t end) {
    const auto charts = surface.face_charts();
    const double pixels = 1.0 / picture.step();
    for (std::size_t face = begin * kFaces; face < std::min(end * kFaces, mesh.triangles.size()); ++face) {
      if (charts[face] == kNone) continue;
      const auto corners = surface.atlas_corners(static_cast<std::uint32_t>(face));
      for (int k = 0; k < 3; ++k)
        for (const double dx : {-0.5, 0.5})
          for (const double dy : {-0.5, 0.5}) {
            const double x = pixels * corners[k][0] + dx, y = pixels * corners[k][1] + dy;
            if (!(x >= 0 && y >= 0 && x < n && y < rows)) continue;
            const std::size_t pixel = static_cast<std::size_t>(y) * n + static_cast<std::size_t>(x);
            if (shown[pixel] == kNone)
              seeds[face / kFaces].push_back(
                  {pixel, vertex_distances[mesh.triangles[face][k]], static_cast<std::uint32_t>(face)});
          }
    }
  });
  for (const std::vector<Seed>& some : seeds)
    for (const auto& [pixel, d, face] : some) {
      if (std::exchange(shown[pixel], 0) != kNone) continue;
      distance[pixel] = d;
      if (!owner.empty()) owner[pixel] = face;
    }
  const atlas::Gutter gutter(n, shown);
  std::ostringstream png;
  write_png(png, n, rows, [&](std::uint32_t y, std::span<Rgb> pixels) {
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t source = gutter.source(x, y);
      pixels[x] =
          source == kNone ? kBackground : scales(owner.empty() ? kNone : owner[source], distance[source]);
    }
  });
  return std::move(png).str();
}

/// The faces all of whose corners have a distance, and the others: glTF forbids NaN, so these form a separate
/// primitive, without _DISTANCE.
std::array<std::vector<std::uint32_t>, 2> faces_by_distance(const Mesh& mesh,
                                                            std::span<const float> vertex_distances) {
  std::array<std::vector<std::uint32_t>, 2> faces;
  for (std::uint32_t face = 0; face < mesh.triangles.size(); ++face) {
    const auto& [a, b, c] = mesh.triangles[face];
    if (a == b || b == c || c == a) continue;  // also a removed face; the validator reports such triangles
    const bool known =
        std::ranges::all_of(mesh.triangles[face], [&](auto v) { return std::isfinite(vertex_distances[v]); });
    faces[known ? 0 : 1].push_back(face);
  }
  return faces;
}

void add_material(GlbModel& glb, const std::string& png, bool unlit) {
  tinygltf::Model& model = glb.model;
  tinygltf::Image image;
  image.bufferView = glb.add_view(png.size(), 0);
  std::ranges::copy(png, glb.view_bytes(image.bufferView));
  image.mimeType = "image/png";
  model.images.push_back(image);
  // No mip levels: they would blend charts that are neighbours only in the atlas.
  tinygltf::Sampler sampler;
  sampler.minFilter = sampler.magFilter = TINYGLTF_TEXTURE_FILTER_LINEAR;
  sampler.wrapS = sampler.wrapT = TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
  model.samplers.push_back(sampler);
  tinygltf::Texture texture;
  texture.sampler = 0;
  texture.source = 0;
  model.textures.push_back(texture);
  tinygltf::Material material;
  material.name = "distance";
  material.doubleSided = true;
  material.pbrMetallicRoughness.baseColorTexture.index = 0;
  material.pbrMetallicRoughness.metallicFactor = 0;  // matt: highlights would hide colours
  material.pbrMetallicRoughness.roughnessFactor = 1;
  if (unlit) {
    material.extensions["KHR_materials_unlit"] = tinygltf::Value(tinygltf::Value::Object{});
    model.extensionsUsed.push_back("KHR_materials_unlit");
  }
  model.materials.push_back(material);
}

void add_scene(GlbModel& glb, const Placement& place, UpAxis up) {
  tinygltf::Node node = placed_node(place, up);
  node.name = "O1";
  node.mesh = 0;
  glb.add_scene({node});
}

GlbModel make_model(const Surface& surface, const DistanceMap& map, std::span<const float> vertex_distances,
                    const PictureOptions& options) {
  const Mesh& mesh = surface.mesh();
  const AtlasPicture picture(surface, options.largest);
  const FaceScales scales(color_scale(surface, map, options), options);
  ShadingNormals normals;
  std::array<ModelVertices, 2> vertices;
  std::string png;
  run_concurrently({[&] {
                      normals = shading_normals(mesh);
                      const auto faces = faces_by_distance(mesh, vertex_distances);
                      for (int k = 0; k < 2; ++k) vertices[k] = model_vertices(surface, normals, faces[k]);
                    },
                    [&] { png = texture_png(surface, map, scales, picture, vertex_distances); }});
  const Model model{
      .mesh = mesh,
      .normals = normals,
      .place = placement(bounds(mesh), options.units),
      .extent = {1.0 * picture.width() * picture.step(), 1.0 * picture.height() * picture.step()},
      .vertex_distances = vertex_distances};
  GlbModel glb;
  glb.model.meshes.emplace_back().name = "O1";
  std::size_t bytes = png.size();
  for (const ModelVertices& part : vertices)
    bytes += part.triangles.size() * sizeof(Triangle) + part.place.size() * 9 * sizeof(float);
  glb.reserve(bytes);
  add_primitive(glb, model, vertices[0], true);
  add_primitive(glb, model, vertices[1], false);
  add_material(glb, png, options.unlit);
  add_scene(glb, model.place, options.up);
  return glb;
}

}  // namespace

void write_glb(const std::filesystem::path& file, const Surface& surface, const DistanceMap& map,
               std::span<const float> vertex_distances, const PictureOptions& options) try {
  if (vertex_distances.size() != surface.mesh().positions.size())
    throw Error("cannot write " + file.string() +
                ": pass one distance for each vertex of the surface's mesh");
  AtomicFile out(file);
  const GlbModel glb = make_model(surface, map, vertex_distances, options);
  tinygltf::TinyGLTF().WriteGltfSceneToStream(&glb.model, out.stream(), false, true);
  out.commit();
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

}  // namespace sdm
