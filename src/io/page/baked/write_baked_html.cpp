#include <sdm/bake_files.h>
#include <sdm/error.h>
#include <sdm/execution.h>

#include <algorithm>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "core/memory.h"
#include "io/file/atomic_file.h"
#include "io/mesh/model/model_vertices.h"
#include "io/page/baked/detailed_model.h"
#include "io/page/report/embedded_page.h"
#include "io/page/report/face_walk.h"
#include "io/page/report/packed_arrays.h"
#include "io/page/report/page_file.h"
#include "io/page/report/page_numbers.h"

namespace sdm {

using namespace io;

namespace {

using Json = nlohmann::ordered_json;

constexpr double kStepsPerTexel = 64;

/// A tangent as octahedral(), and above these 16 bits whether w is −1.
std::uint32_t packed_tangent(const MeshAttribute& tangents, std::uint32_t row) {
  const float* const t = &tangents.values[4 * std::size_t{row}];
  return octahedral({t[0], t[1], t[2]}) | (t[3] < 0 ? 1u << 16 : 0u);
}

/// Adds the coarse mesh. Arrays: `low_triangle`, and for each vertex `low_position`, `low_normal`,
/// `low_place` (two, in 1/64 of a texel of the surface, y down) and, if there are tangents, `low_tangent`.
Json add_coarse(PackedArrays& arrays, const Surface& surface, const BakedModelOptions& options,
                const Steps& steps) {
  const Mesh& mesh = surface.mesh();
  const ShadingNormals normals =
      options.normals != nullptr ? mesh::sheet_normals(mesh, *options.normals) : shading_normals(mesh);
  const ModelVertices vertices = model_vertices(surface, normals, drawn_faces(mesh), options.tangents);
  const FaceWalk walk = walk_over(vertices.triangles, vertices.normal.size());
  std::vector<std::uint32_t> position, normal, place, tangent;
  for (const std::uint32_t v : walk.vertex) {
    const std::uint32_t n = vertices.normal[v];
    const Vec3& at = mesh.positions[normals.vertex[n]];
    for (int k = 0; k < 3; ++k) position.push_back(steps(at, k));
    normal.push_back(octahedral(normals.normals[n]));
    for (const double x : vertices.place[v])
      place.push_back(static_cast<std::uint32_t>(std::max(0.0, kStepsPerTexel * x + 0.5)));
    if (options.tangents != nullptr)
      tangent.push_back(packed_tangent(*options.tangents, vertices.tangent[v]));
  }
  const auto guesses = guesses_of(walk.triangles);
  arrays.add("low_triangle", corner_codes(walk.triangles));
  arrays.add_guessed("low_position", position, 3, guesses);
  arrays.add("low_normal", std::move(normal));
  arrays.add_guessed("low_place", place, 2, guesses);
  if (!tangent.empty()) arrays.add("low_tangent", std::move(tangent));
  return {{"triangles", walk.triangles.size()},
          {"width", kStepsPerTexel * surface.resolution()},
          {"height", kStepsPerTexel * surface.rows()}};
}

Json picture_json(std::span<const char> png) {
  const std::vector<std::uint8_t> bytes(png.begin(), png.end());
  return {{"bytes", bytes.size()}, {"text", base85(bytes)}};
}

Json pictures_json(std::span<const BakedTexture> textures, const BakedModelOptions& options) {
  Json json = Json::object();
  for (const BakedTexture& texture : textures)
    json[std::string(name_of(texture.channel))] = picture_json(texture.png);
  if (!options.normal_map.empty()) json["normal"] = picture_json(options.normal_map);
  return json;
}

}  // namespace

void write_baked_html(const std::filesystem::path& file, const Surface& surface,
                      std::span<const BakedTexture> textures, const BakedModelOptions& options,
                      const DetailedView& o2, const std::string& report) try {
  if (options.normal_map.empty() != (options.tangents == nullptr) ||
      (options.tangents != nullptr && options.normals == nullptr))
    throw Error("cannot write " + file.string() +
                ": a normal map needs the normals and tangents that it was made with");
  AtomicFile out(file);
  const DetailedView::Data& detailed = o2.data();
  Json low, pictures;
  PackedArrays arrays;
  run_concurrently({[&] { low = add_coarse(arrays, surface, options, detailed.steps); },
                    [&] { pictures = pictures_json(textures, options); }});
  arrays.add(PackedArrays(detailed.arrays));
  compress(arrays);
  Json page = common_json(options.up);
  page["place"] = detailed.steps.json();
  page["low"] = low;
  page["high"] = detailed.counts;
  page["pictures"] = pictures;
  page["base_color"] = options.material.base_color;
  page["emissive"] = options.material.emissive;
  page["metallic"] = options.material.metallic;
  page["roughness"] = options.material.roughness;
  page["alpha_mode"] = static_cast<int>(options.material.alpha_mode);
  page["alpha_cutoff"] = options.material.alpha_cutoff;
  put_page(out.stream(), kBakedHtml.bytes, page, &report, arrays);
  out.commit();
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

}  // namespace sdm
