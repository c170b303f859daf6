#include "atlas/gutter.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "io/file/atomic_file.h"
#include "io/image/pictures/atlas_picture.h"
#include "io/image/pictures/color_scale.h"
#include "io/image/pictures/face_scales.h"
#include "io/image/pictures/png.h"
#include "io/mesh/model/drawn_surface.h"
#include "io/mesh/model/glb_model.h"
#include "io/mesh/model/model_vertices.h"
#include "io/mesh/model/shading_normals.h"

#include <sdm/error.h>
#include <sdm/execution.h>
#include <sdm/map_files.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace sdm {

using namespace io;

namespace {

void add_primitive(GlbModel& glb, const DrawnSurface& drawn, const ModelVertices& vertices,
                   std::span<const float> vertex_distances) {
  if (vertices.triangles.empty()) return;
  tinygltf::Primitive primitive = primitive_of(glb, drawn, vertices);
  if (!vertex_distances.empty())
    primitive.attributes["_DISTANCE"] = glb.add_accessor<float>(
        vertices.place.size(), TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_FLOAT,
        TINYGLTF_TARGET_ARRAY_BUFFER,
        [&](std::size_t i, float& d) { d = vertex_distances[drawn.normals.vertex[vertices.normal[i]]]; });
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
  // No mip levels: they would blend charts that are neighbours only in the atlas.
  const int texture = add_png(glb, png, TINYGLTF_TEXTURE_FILTER_LINEAR);
  tinygltf::Material material;
  material.name = "distance";
  material.doubleSided = true;
  material.pbrMetallicRoughness.baseColorTexture.index = texture;
  material.pbrMetallicRoughness.metallicFactor = 0;  // matt: highlights would hide colours
  material.pbrMetallicRoughness.roughnessFactor = 1;
  if (unlit) {
    material.extensions["KHR_materials_unlit"] = tinygltf::Value(tinygltf::Value::Object{});
    glb.model.extensionsUsed.push_back("KHR_materials_unlit");
  }
  glb.model.materials.push_back(material);
}

GlbModel make_model(const Surface& surface, const DistanceMap& map, std::span<const float> vertex_distances,
                    const PictureOptions& options) {
  const Mesh& mesh = surface.mesh();
  const AtlasPicture picture(surface, options.largest);
  const FaceScales scales(color_scale(surface, map, options), options);
  std::array<ModelVertices, 2> vertices;
  std::string png;
  run_concurrently({[&] {
                      const auto faces = faces_by_distance(mesh, vertex_distances);
                      for (int k = 0; k < 2; ++k)
                        vertices[k] = model_vertices(surface, shading_normals(surface), faces[k]);
                    },
                    [&] { png = texture_png(surface, map, scales, picture, vertex_distances); }});
  const DrawnSurface drawn{
      .mesh = mesh,
      .normals = shading_normals(surface),
      .place = placement(bounds(mesh), options.units),
      .extent = {1.0 * picture.width() * picture.step(), 1.0 * picture.height() * picture.step()}};
  GlbModel glb;
  glb.model.meshes.emplace_back().name = "O1";
  std::size_t bytes = png.size();
  for (const ModelVertices& part : vertices) bytes += bytes_of(part) + part.place.size() * sizeof(float);
  glb.reserve(bytes);
  add_primitive(glb, drawn, vertices[0], vertex_distances);
  add_primitive(glb, drawn, vertices[1], {});
  add_material(glb, png, options.unlit);
  glb.add_scene({drawn_node(drawn.place, options.up)});
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
