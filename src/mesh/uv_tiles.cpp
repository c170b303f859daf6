#include <sdm/error.h>
#include <sdm/mesh_attributes.h>
#include <sdm/mesh_edit.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <new>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/memory.h"

namespace sdm {
namespace {

constexpr double kOutside = 1e-6;     // as for AtlasKind::uv
constexpr double kLeastArea = 1e-14;  // of a piece, of the texture
constexpr double kMostTiles = 1e6;    // from the origin
// Limits for all faces that are cut together. One face may take all of the first ones: a texture that repeats
// a hundred times on two triangles.
constexpr double kMostPieces = 1 << 16, kMostPiecesPerFace = 16;

// The range of tiles that a face meets by more than rounding, in one direction.
std::array<std::int32_t, 2> tile_range(const std::array<Vec2, 3>& uv, int axis) {
  const auto [lo, hi] = std::minmax({uv[0][axis], uv[1][axis], uv[2][axis]});
  const auto first = static_cast<std::int32_t>(std::floor(lo + kOutside));
  const auto last = static_cast<std::int32_t>(std::ceil(hi - kOutside)) - 1;
  return {first, std::max(first, last)};
}

// Whether all corners are on the border between two tiles, to either of which the face may belong.
bool is_on_border(const std::array<Vec2, 3>& uv, int axis) {
  const auto [lo, hi] = std::minmax({uv[0][axis], uv[1][axis], uv[2][axis]});
  return std::floor(lo + kOutside) > std::ceil(hi - kOutside) - 1;
}

// A corner of a piece: its texture coordinates, and its weights of the corners of the face.
struct Corner {
  Vec2 uv;
  Vec3 weights;
};
using Piece = std::vector<Corner>;

// The part with side · uv[axis] ≥ side · at; Sutherland and Hodgman.
Piece clipped(const Piece& piece, int axis, double at, double side) {
  Piece result;
  for (std::size_t i = 0; i < piece.size(); ++i) {
    const Corner &a = piece[i], &b = piece[(i + 1) % piece.size()];
    const double from = side * (a.uv[axis] - at), to = side * (b.uv[axis] - at);
    if (from >= 0) result.push_back(a);
    if ((from > 0 && to < 0) || (from < 0 && to > 0)) {
      const double t = from / (from - to);
      Corner& cut =
          result.emplace_back(Corner{(1 - t) * a.uv + t * b.uv, (1 - t) * a.weights + t * b.weights});
      cut.uv[axis] = at;
    }
  }
  return result;
}

double area(const Vec2& a, const Vec2& b, const Vec2& c) {
  return 0.5 * std::abs(cross(b - a, c - a));
}

// Cuts faces into the pieces in each tile, and adds them to the mesh.
class FaceCuts {
 public:
  FaceCuts(const Mesh& original, WrappedUvs& result) : original_(original), result_(result) {}

  void cut(std::uint32_t face) {
    const auto& uv = original_.corner_uvs[face];
    const Piece whole{{uv[0], {1, 0, 0}}, {uv[1], {0, 1, 0}}, {uv[2], {0, 0, 1}}};
    added_.clear();
    first_ = true;
    const auto columns = tile_range(uv, 0), rows = tile_range(uv, 1);
    for (std::int32_t u = columns[0]; u <= columns[1]; ++u) {
      const Piece column =
          clipped(clipped(whole, 0, u, u > columns[0] ? 1 : 0), 0, u + 1, u < columns[1] ? -1 : 0);
      for (std::int32_t v = rows[0]; v <= rows[1]; ++v)
        add(face, clipped(clipped(column, 1, v, v > rows[0] ? 1 : 0), 1, v + 1, v < rows[1] ? -1 : 0),
            {1.0 * u, 1.0 * v});
    }
    // Nothing but slivers: the face stays where it is, within the first of its tiles up to their width.
    if (first_) add(face, whole, {1.0 * columns[0], 1.0 * rows[0]}, 0);
    ++result_.cut_faces;
  }

 private:
  void add(std::uint32_t face, const Piece& piece, const Vec2& tile, double least_area = kLeastArea) {
    for (std::size_t i = 2; i < piece.size(); ++i) {
      const std::array corners{piece[0], piece[i - 1], piece[i]};
      if (!(area(corners[0].uv, corners[1].uv, corners[2].uv) >= least_area)) continue;
      Triangle triangle;
      std::array<Vec2, 3> uvs;
      for (int k = 0; k < 3; ++k) {
        triangle[k] = vertex(face, corners[k].weights);
        for (int axis = 0; axis < 2; ++axis)
          uvs[k][axis] = std::clamp(corners[k].uv[axis] - tile[axis], 0.0, 1.0);
      }
      if (std::exchange(first_, false)) {
        result_.mesh.triangles[face] = triangle;
        result_.mesh.corner_uvs[face] = uvs;
      } else {
        result_.mesh.triangles.push_back(triangle);
        result_.mesh.corner_uvs.push_back(uvs);
        result_.source_face.push_back(face);
      }
    }
  }

  // The vertex of the mesh at a point of the face: a corner, or one added for this face.
  std::uint32_t vertex(std::uint32_t face, const Vec3& weights) {
    const Triangle& t = original_.triangles[face];
    for (int k = 0; k < 3; ++k)
      if (weights[k] == 1) return t[k];
    const auto [known, is_new] =
        added_.emplace(weights, static_cast<std::uint32_t>(result_.mesh.positions.size()));
    if (is_new) {
      const auto& p = original_.positions;
      result_.mesh.positions.push_back(weights[0] * p[t[0]] + weights[1] * p[t[1]] + weights[2] * p[t[2]]);
    }
    return known->second;
  }

  const Mesh& original_;
  WrappedUvs& result_;
  std::map<Vec3, std::uint32_t> added_;  ///< vertices of the present face, by their weights
  bool first_ = true;                    ///< whether the next piece replaces the face
};

void check_coordinates(const Mesh& mesh) {
  if (mesh.corner_uvs.size() != mesh.triangles.size() || mesh.triangles.empty())
    throw Error("not every corner of every face of the mesh has texture coordinates; use an atlas of charts",
                Remedy::atlas_kind);
  for (std::size_t f = 0; f < mesh.corner_uvs.size(); ++f)
    for (const Vec2& uv : mesh.corner_uvs[f])
      if (!(std::abs(uv[0]) <= kMostTiles && std::abs(uv[1]) <= kMostTiles))
        throw Error("the texture coordinates of face " + std::to_string(f) +
                        " are beyond 10^6; use an atlas of charts",
                    Remedy::atlas_kind);
}

// Tiles are counted in the box of each face, since all of them are visited.
void check_pieces(const Mesh& mesh, const UvTiles& tiles) {
  const double most = kMostPieces + kMostPiecesPerFace * static_cast<double>(mesh.triangles.size());
  double pieces = 0, largest = 0;
  std::uint32_t face = 0;
  for (const std::uint32_t f : tiles.crossing) {
    const auto u = tile_range(mesh.corner_uvs.at(f), 0), v = tile_range(mesh.corner_uvs.at(f), 1);
    const double of_face = (u[1] - u[0] + 1.0) * (v[1] - v[0] + 1.0);
    pieces += of_face;
    if (of_face > largest) {
      largest = of_face;
      face = f;
    }
  }
  const auto text = [](double count) { return std::to_string(static_cast<std::uint64_t>(count)); };
  if (pieces > most)
    throw Error("the texture repeats too often on the mesh: it would be cut into " + text(pieces) +
                    " pieces, " + text(largest) + " of them of face " + std::to_string(face) +
                    ", where at most " + text(most) + " are possible; use an atlas of charts",
                Remedy::atlas_kind);
}

}  // namespace

bool UvTiles::is_udim() const {
  return crossing.empty() && tiles.size() > 1 &&
         std::ranges::all_of(tiles, [](const UvTile& tile) { return tile.has_udim(); });
}

bool UvTiles::is_unit_square() const {
  return crossing.empty() && tiles.size() == 1 && tiles[0].u == 0 && tiles[0].v == 0;
}

bool has_one_uv(const Mesh& mesh) {
  return !mesh.corner_uvs.empty() &&
         std::ranges::all_of(mesh.corner_uvs, [&](const std::array<Vec2, 3>& uvs) {
           return std::ranges::all_of(uvs, [&](const Vec2& uv) { return uv == mesh.corner_uvs[0][0]; });
         });
}

UvTiles uv_tiles(const Mesh& mesh) try {
  check_coordinates(mesh);
  UvTiles result;
  std::map<std::array<std::int32_t, 2>, std::vector<std::uint32_t>> tiles;  // by v, u
  std::vector<std::uint32_t> on_borders;
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    if (is_removed(mesh.triangles[f])) continue;
    const auto u = tile_range(mesh.corner_uvs[f], 0), v = tile_range(mesh.corner_uvs[f], 1);
    if (u[0] < u[1] || v[0] < v[1])
      result.crossing.push_back(f);
    else if (is_on_border(mesh.corner_uvs[f], 0) || is_on_border(mesh.corner_uvs[f], 1))
      on_borders.push_back(f);
    else
      tiles[{v[0], u[0]}].push_back(f);
  }
  // A face on a border belongs to a tile that has other faces; if neither has, to the one in the unit square
  // or nearest to it.
  std::set<std::array<std::int32_t, 2>> used;
  for (const auto& [place, faces] : tiles) used.insert(place);
  for (const std::uint32_t f : on_borders) {
    const auto choices = [&](int axis) {
      const std::int32_t after = tile_range(mesh.corner_uvs[f], axis)[0];
      if (!is_on_border(mesh.corner_uvs[f], axis)) return std::array{after, after};
      return after > 0 ? std::array{after - 1, after} : std::array{after, after - 1};
    };
    const auto u = choices(0), v = choices(1);
    std::array<std::int32_t, 2> place{v[0], u[0]};
    for (int i = 3; i >= 0; --i)
      if (const std::array other{v[i / 2], u[i % 2]}; used.contains(other)) place = other;
    tiles[place].push_back(f);
  }
  for (auto& [place, faces] : tiles) std::ranges::sort(faces);
  for (auto& [place, faces] : tiles) result.tiles.push_back({place[1], place[0], std::move(faces)});
  return result;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the tiles of texture coordinates");
}

Mesh uv_tile_mesh(const Mesh& mesh, const UvTile& tile) try {
  Mesh result{.positions = mesh.positions, .triangles = {}, .corner_uvs = {}};
  for (const std::uint32_t f : tile.faces) {
    result.triangles.push_back(mesh.triangles.at(f));
    std::array<Vec2, 3>& uvs = result.corner_uvs.emplace_back(mesh.corner_uvs.at(f));
    for (auto& [u, v] : uvs) {
      u = std::clamp(u - tile.u, 0.0, 1.0);
      v = std::clamp(v - tile.v, 0.0, 1.0);
    }
  }
  return result;
} catch (const std::bad_alloc&) {
  throw out_of_memory("a tile of texture coordinates");
}

WrappedUvs wrap_uvs(const Mesh& mesh, const UvTiles& tiles) try {
  check_coordinates(mesh);
  check_pieces(mesh, tiles);
  WrappedUvs result{.mesh = mesh, .source_face = {}};
  result.source_face.resize(mesh.triangles.size());
  for (std::uint32_t f = 0; f < result.source_face.size(); ++f) result.source_face[f] = f;
  for (const UvTile& tile : tiles.tiles)
    for (const std::uint32_t f : tile.faces)
      for (auto& [u, v] : result.mesh.corner_uvs.at(f)) {
        u = std::clamp(u - tile.u, 0.0, 1.0);
        v = std::clamp(v - tile.v, 0.0, 1.0);
      }
  FaceCuts cuts(mesh, result);
  for (const std::uint32_t f : tiles.crossing) cuts.cut(f);
  return result;
} catch (const std::bad_alloc&) {
  throw out_of_memory("wrapping texture coordinates");
}

}  // namespace sdm
