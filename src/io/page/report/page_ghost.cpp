#include "io/page/report/page_ghost.h"

#include <sdm/types.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "io/page/report/face_walk.h"
#include "io/page/report/page_numbers.h"

namespace sdm::io {
namespace {

using Json = nlohmann::ordered_json;

/// Triangles with the vertices that they have in common.
class GhostTriangles {
 public:
  GhostTriangles(const Mesh& mesh, const Steps& steps)
      : mesh_(mesh), steps_(steps), number_(mesh.positions.size(), kNone) {}

  void add(const Triangle& face) {
    Triangle& triangle = triangles_.emplace_back(face);
    for (std::uint32_t& vertex : triangle) {
      if (number_[vertex] == kNone) number_[vertex] = append(in_steps(mesh_.positions[vertex]));
      vertex = number_[vertex];
    }
  }
  void add(const std::array<Vec3, 3>& corners) {
    Triangle& triangle = triangles_.emplace_back();
    for (int k = 0; k < 3; ++k) {
      const Place place = in_steps(corners[k]);
      const auto [at, is_new] = corner_at_.try_emplace(place, kNone);
      if (is_new) at->second = append(place);
      triangle[k] = at->second;
    }
  }
  /// `covered`: of each triangle, or nothing.
  void put(PackedArrays& arrays, std::span<const std::uint32_t> covered) const {
    const FaceWalk walk = walk_over(triangles_, position_.size() / 3);
    std::vector<std::uint32_t> position, of_walk;
    for (const std::uint32_t v : walk.vertex)
      for (int k = 0; k < 3; ++k) position.push_back(position_[3 * v + k]);
    arrays.add("ghost_triangle", corner_codes(walk.triangles));
    arrays.add_guessed("ghost_position", position, 3, guesses_of(walk.triangles));
    if (covered.empty()) return;
    for (const std::uint32_t f : walk.from) of_walk.push_back(covered[f]);
    arrays.add("ghost_covered", std::move(of_walk));
  }

 private:
  using Place = std::array<std::uint32_t, 3>;

  [[nodiscard]] Place in_steps(const Vec3& p) const { return {steps_(p, 0), steps_(p, 1), steps_(p, 2)}; }
  std::uint32_t append(const Place& place) {
    position_.insert(position_.end(), place.begin(), place.end());
    return static_cast<std::uint32_t>(position_.size() / 3 - 1);
  }

  const Mesh& mesh_;
  const Steps& steps_;
  std::vector<std::uint32_t> number_;  // of each vertex of the mesh
  std::map<Place, std::uint32_t> corner_at_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> position_;
};

/// Adds the faces, those that are covered in part by their pieces. Returns whether each triangle is covered.
std::vector<std::uint32_t> add_covered(GhostTriangles& triangles, const Mesh& mesh,
                                       const CoverageMap& coverage, bool with_pieces) {
  std::vector<std::uint32_t> covered;
  std::span<const CoveragePiece> pieces;
  if (with_pieces) pieces = coverage.pieces;
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    const bool in_part = !pieces.empty() && pieces.front().face == f;
    for (; !pieces.empty() && pieces.front().face == f; pieces = pieces.subspan(1)) {
      triangles.add(pieces.front().corners);
      covered.push_back(pieces.front().covered ? 1 : 0);
    }
    if (in_part || !is_visible(mesh.triangles[f])) continue;
    triangles.add(mesh.triangles[f]);
    covered.push_back(coverage.of_face[f] < 0.5F ? 0 : 1);  // without area, nothing is missing
  }
  return covered;
}

}  // namespace

Json add_ghost(PackedArrays& arrays, const Mesh& mesh, const CoverageMap* coverage, std::size_t most) {
  const Box box = bounds(mesh);
  const Steps steps(box);
  Json json = steps.json();
  json["box"] = {{"lo", box.lower}, {"hi", box.upper}};
  const auto visible = static_cast<std::size_t>(std::ranges::count_if(mesh.triangles, is_visible));
  json["triangles_of_mesh"] = visible;
  if (visible > most) return json;
  GhostTriangles triangles(mesh, steps);
  std::vector<std::uint32_t> covered;
  if (coverage) {
    const bool with_pieces = visible + coverage->pieces.size() <= most;
    covered = add_covered(triangles, mesh, *coverage, with_pieces);
  } else {
    for (const Triangle& face : mesh.triangles)
      if (is_visible(face)) triangles.add(face);
  }
  triangles.put(arrays, covered);
  return json;
}

}  // namespace sdm::io
