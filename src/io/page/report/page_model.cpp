#include "io/page/report/page_model.h"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <string>

#include "core/parallel.h"
#include "io/image/pictures/atlas_picture.h"
#include "io/mesh/model/model_vertices.h"
#include "io/mesh/model/shading_normals.h"
#include "io/page/report/face_walk.h"
#include "io/page/report/fewer_vertices.h"
#include "io/page/report/page_channels.h"
#include "io/page/report/page_numbers.h"

namespace sdm::io {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kStepsPerTexel = 64;  // of `place`

// What is left of each value after a guess from the texels to its left, above it, and between these: the
// field is nearly linear. Of the others the guess is one neighbour, or the value before.
std::vector<std::uint32_t> differences_of_map(std::span<const std::uint32_t> charts,
                                              std::span<const std::uint32_t> values, std::size_t width) {
  std::vector<std::uint32_t> result;
  std::uint32_t last = 0;
  for (std::size_t i = 0; i < charts.size(); ++i) {
    if (charts[i] == 0) continue;
    const bool left = i % width > 0 && charts[i - 1] != 0, above = i >= width && charts[i - width] != 0;
    std::uint32_t guess = last;
    if (left && above && charts[i - width - 1] != 0)
      guess = values[i - 1] + values[i - width] - values[i - width - 1];
    else if (left)
      guess = values[i - 1];
    else if (above)
      guess = values[i - width];
    result.push_back(zigzag(values[i] - guess));
    last = values[i];
  }
  return result;
}

// The visible faces, those of a chart together: neighbours in the atlas are neighbours in the file.
std::vector<std::uint32_t> faces_by_chart(const Surface& surface) {
  const auto charts = surface.face_charts();
  std::vector<std::uint32_t> faces(charts.size());
  std::iota(faces.begin(), faces.end(), 0u);
  std::erase_if(faces, [&](std::uint32_t face) {
    return charts[face] == kNone || !is_visible(surface.mesh().triangles[face]);
  });
  std::ranges::stable_sort(faces, {}, [&](std::uint32_t face) { return charts[face]; });
  return faces;
}

// Normals as what is left of each byte after that of the vertex which a number is guessed from.
std::vector<std::uint32_t> guessed_normals(std::span<const std::uint32_t> normals,
                                           std::span<const std::array<std::uint32_t, 3>> guesses) {
  std::vector<std::uint32_t> result(normals.begin(), normals.end());
  for (std::size_t v = 0; v < normals.size(); ++v) {
    const std::uint32_t from = guesses[v][0] == kNone ? 0 : normals[guesses[v][0]];
    result[v] = ((normals[v] - from) & 0xFF) | ((((normals[v] >> 8) - (from >> 8)) & 0xFF) << 8);
  }
  return result;
}

// Adds the triangles of a walk, and its vertices; `normal_of`: of each vertex before the walk.
void add_walk(PackedArrays& arrays, const FaceWalk& walk, const Mesh& mesh, const ShadingNormals& normals,
              std::span<const std::uint32_t> normal_of, const Steps& steps,
              std::span<const float> vertex_distances) {
  std::vector<std::uint32_t> position, normal, distance;
  for (const std::uint32_t v : walk.vertex) {
    const std::uint32_t n = normal_of[v], vertex = normals.vertex[n];
    for (int k = 0; k < 3; ++k) position.push_back(steps(mesh.positions[vertex], k));
    normal.push_back(octahedral(normals.normals[n]));
    distance.push_back(ordered(vertex_distances[vertex]));
  }
  const auto guesses = guesses_of(walk.triangles);
  arrays.add("triangle", corner_codes(walk.triangles));
  arrays.add_guessed("position", position, 3, guesses);
  arrays.add("normal", guessed_normals(normal, guesses));
  arrays.add_guessed("vertex_distance", distance, 1, guesses);
}

}  // namespace

Json add_map(PackedArrays& arrays, const Surface& surface, const DistanceMap& map, std::uint32_t largest) {
  const AtlasPicture picture(surface, largest);
  const std::size_t width = picture.width(), height = picture.height();
  const auto owners = surface.texel_faces(), face_charts = surface.face_charts();
  const PageChannels shown;
  std::vector<std::uint32_t> charts(width * height), sites(charts.size());
  std::vector<std::vector<std::uint32_t>> values(shown.planes(), std::vector<std::uint32_t>(charts.size()));
  std::atomic<bool> sites_fit = true;
  constexpr std::size_t kGrain = 16;  // rows
  parallel_for(height, kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> texels(width);
    for (std::size_t y = begin; y < end; ++y) {
      for (std::size_t x = 0; x < width; ++x)
        texels[x] = picture.texel(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
      shown.read({.map = &map, .surface = &surface}, texels, y * width, values);
      for (std::size_t x = 0; x < width; ++x) {
        const std::uint32_t texel = texels[x];
        if (texel == kNone) continue;
        charts[y * width + x] = face_charts[owners[texel]] + 1;
        const SiteType type = map.site_type[texel];
        const std::uint32_t site = map.site[texel];
        if (type != SiteType::none && site >= (1u << 30) - 1) sites_fit = false;
        sites[y * width + x] = type == SiteType::none ? kNone : site << 2 | static_cast<std::uint32_t>(type);
      }
    }
  });
  arrays.add_differences("chart", charts);
  Json json{{"width", width}, {"height", height}, {"step", picture.step()}};
  std::size_t plane = 0;
  for (const Channel& channel : shown.channels()) {
    for (std::size_t k = 0; k < channel.components(); ++k)
      arrays.add(array_name(channel, k), differences_of_map(charts, values[plane++], width));
    if (!is_drawn(channel)) json["channels"].push_back(described(channel));
  }
  if (sites_fit) {
    std::size_t owned = 0;
    for (std::size_t i = 0; i < sites.size(); ++i)
      if (charts[i] != 0) sites[owned++] = sites[i];
    arrays.add_differences("site", std::span(sites).first(owned));
  }
  return json;
}

Json add_model(PackedArrays& arrays, const Surface& surface, std::span<const float> vertex_distances,
               std::span<const FaceNames> names, std::uint32_t largest, std::size_t most) {
  const Mesh& mesh = surface.mesh();
  const Steps steps(bounds(mesh));
  Json json = steps.json();
  const std::vector<std::uint32_t> faces = faces_by_chart(surface);
  json["triangles_of_mesh"] = faces.size();
  if (faces.size() > most) {
    const FewerVertices fewer = fewer_vertices(mesh, vertex_distances, most);
    const ShadingNormals normals = shading_normals(fewer.mesh);
    // Every vertex once: with the first of its normals.
    std::vector<std::uint32_t> normal_of(fewer.mesh.positions.size(), kNone);
    for (std::uint32_t n = 0; n < normals.vertex.size(); ++n)
      if (normal_of[normals.vertex[n]] == kNone) normal_of[normals.vertex[n]] = n;
    const FaceWalk walk = walk_over(fewer.mesh.triangles, fewer.mesh.positions.size());
    add_walk(arrays, walk, fewer.mesh, normals, normal_of, steps, fewer.distances);
    return json;
  }
  const ShadingNormals& normals = shading_normals(surface);
  const ModelVertices vertices = model_vertices(surface, normals, faces);
  const FaceWalk walk = walk_over(vertices.triangles, vertices.normal.size());
  add_walk(arrays, walk, mesh, normals, vertices.normal, steps, vertex_distances);
  const double scale = kStepsPerTexel / AtlasPicture(surface, largest).step();
  std::vector<std::uint32_t> place;
  for (const std::uint32_t v : walk.vertex)
    for (const double x : vertices.place[v])
      place.push_back(static_cast<std::uint32_t>(std::max(0.0, scale * x + 0.5)));
  arrays.add_guessed("place", place, 2, guesses_of(walk.triangles));
  std::vector<std::uint32_t> charts;
  for (const std::uint32_t f : walk.from) charts.push_back(surface.face_charts()[faces[f]] + 1);
  arrays.add_differences("triangle_chart", charts);
  for (std::size_t k = 0; k < names.size(); ++k) {
    std::vector<std::uint32_t> numbers;
    for (const std::uint32_t f : walk.from)
      numbers.push_back(names[k].of_face[faces[f]] + 1);  // kNone + 1 is 0
    arrays.add_differences("triangle_name_" + std::to_string(k), numbers);
    json["names"].push_back({{"kind", names[k].kind}, {"names", names[k].names}});
  }
  return json;
}

}  // namespace sdm::io
