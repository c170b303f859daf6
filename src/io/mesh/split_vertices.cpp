#include "io/mesh/split_vertices.h"

#include <algorithm>
#include <map>
#include <numeric>

namespace sdm::io {

SplitVertices split_vertices(const Mesh& mesh, std::span<const CornerRows> arrays) {
  const std::size_t count = mesh.positions.size();
  // The combinations of each vertex are a linked list, which begins with the first one: first[vertex] ...
  std::vector<std::uint32_t> first(count, kNone), next, of;
  std::vector<std::vector<std::uint32_t>> rows(arrays.size());
  std::vector<Triangle> combinations(mesh.triangles.size());
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[f][k];
      const auto fits = [&](std::uint32_t combination) {
        for (std::size_t a = 0; a < arrays.size(); ++a)
          if (rows[a][combination] != (*arrays[a].rows)[f][k]) return false;
        return true;
      };
      std::uint32_t at = first[v];
      while (at != kNone && !fits(at)) at = next[at];
      if (at == kNone) {
        at = static_cast<std::uint32_t>(of.size());
        of.push_back(v);
        for (std::size_t a = 0; a < arrays.size(); ++a) rows[a].push_back((*arrays[a].rows)[f][k]);
        next.push_back(std::exchange(first[v], at));
      }
      combinations[f][k] = at;
    }
  for (std::uint32_t v = 0; v < count; ++v)
    if (first[v] == kNone) {
      of.push_back(v);
      for (std::vector<std::uint32_t>& array : rows) array.push_back(kNone);
    }
  std::vector<std::uint32_t> order(of.size()), place(of.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t combination) { return of[combination]; });
  SplitVertices result;
  result.rows.resize(arrays.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    place[order[i]] = i;
    result.vertex.push_back(of[order[i]]);
    for (std::size_t a = 0; a < arrays.size(); ++a) result.rows[a].push_back(rows[a][order[i]]);
  }
  for (const Triangle& t : combinations) result.triangles.push_back({place[t[0]], place[t[1]], place[t[2]]});
  return result;
}

UvRows uv_rows(const Mesh& mesh) {
  UvRows rows;
  std::map<Vec2, std::uint32_t> number;
  rows.of.reserve(mesh.corner_uvs.size());
  for (const auto& corners : mesh.corner_uvs) {
    Triangle& t = rows.of.emplace_back();
    for (int k = 0; k < 3; ++k) {
      const auto [at, is_new] = number.try_emplace(corners[k], static_cast<std::uint32_t>(rows.uvs.size()));
      if (is_new) rows.uvs.push_back(corners[k]);
      t[k] = at->second;
    }
  }
  return rows;
}

const MeshAttribute* find_attribute(std::span<const MeshAttribute> attributes, std::string_view name,
                                    std::size_t least, std::size_t most) {
  const auto found = std::ranges::find(attributes, name, &MeshAttribute::name);
  if (found == attributes.end() || !found->rows) return nullptr;
  return found->components >= least && found->components <= most ? &*found : nullptr;
}

const char* picture_format(std::span<const char> bytes) {
  const std::string_view text(bytes.data(), bytes.size());
  if (text.starts_with("\x89PNG")) return "png";
  if (text.starts_with("\xff\xd8")) return "jpg";
  constexpr std::size_t kRiffHeader = 8;
  if (text.starts_with("RIFF") && text.substr(std::min(kRiffHeader, text.size())).starts_with("WEBP"))
    return "webp";
  return "bin";
}

}  // namespace sdm::io
