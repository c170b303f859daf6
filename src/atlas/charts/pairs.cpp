#include "atlas/charts/pairs.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace sdm::atlas {
namespace {

// An edge lies in the planes of both faces, up to this sine. Edges as short as the rounding of their ends may
// not.
constexpr double kFlat = 1e-9;

// What an edge saves: a gutter of its length on both sides.
struct Saving {
  double squared_length = 0;  ///< 0: the faces cannot be paired
  std::uint32_t first = 0, second = 0;

  [[nodiscard]] auto operator<=>(const Saving&) const = default;
};

/// Disjoint pairs of adjacent faces.
class Matching {
 public:
  Matching(const Mesh& mesh, const FaceGeometry& faces)
      : mesh_(mesh), faces_(faces), partner_(mesh.triangles.size(), kNone) {}

  /// Pairs every two faces for both of which their common edge saves most, among faces not yet paired: the
  /// longest edges first, without sorting them (Preis 1999).
  void match_dominant() {
    const auto count = static_cast<std::uint32_t>(partner_.size());
    choice_.resize(count);
    for (std::uint32_t f = 0; f < count; ++f) choice_[f] = best(f);
    std::vector<std::uint32_t> paired;
    const auto try_pair = [&](std::uint32_t f) {
      const std::uint32_t g = choice_[f];
      if (partner_[f] != kNone || g == kNone || choice_[g] != f) return;
      pair(f, g);
      paired.insert(paired.end(), {f, g});
    };
    for (std::uint32_t f = 0; f < count; ++f) {
      try_pair(f);
      while (!paired.empty()) {
        const std::uint32_t taken = paired.back();
        paired.pop_back();
        for (const std::uint32_t g : faces_.neighbours[taken])
          if (g != kNone && partner_[g] == kNone && choice_[g] == taken) {
            choice_[g] = best(g);
            try_pair(g);
          }
      }
    }
  }

  /// Where a pair lies between two single faces, makes two pairs of the four.
  void augment() {
    for (std::uint32_t f = 0; f < partner_.size(); ++f)
      for (int k = 0; k < 3 && partner_[f] == kNone; ++k) {
        const std::uint32_t g = faces_.neighbours[f][k];
        if (!(saving(f, k).squared_length > 0)) continue;
        const std::uint32_t other = partner_[g];
        const std::uint32_t single = best(other);
        if (single == kNone || single == f) continue;
        pair(f, g);
        pair(other, single);
      }
  }

  [[nodiscard]] std::uint32_t partner(std::uint32_t face) const { return partner_[face]; }

 private:
  void pair(std::uint32_t f, std::uint32_t g) {
    partner_[f] = g;
    partner_[g] = f;
  }

  // That of unfolding a face and its neighbour across side k. They cannot be where one of them is turned
  // over, or where they share another side as well.
  [[nodiscard]] Saving saving(std::uint32_t face, int k) const {
    const std::uint32_t other = faces_.neighbours[face][k];
    if (other == kNone || !(faces_.area[face] > 0) || !(faces_.area[other] > 0)) return {};
    const std::uint32_t from = mesh_.triangles[face][k], to = mesh_.triangles[face][(k + 1) % 3];
    int shared = 0;
    bool consistent = false;
    for (int j = 0; j < 3; ++j) {
      shared += faces_.neighbours[other][j] == face;
      consistent |= mesh_.triangles[other][j] == to && mesh_.triangles[other][(j + 1) % 3] == from;
    }
    if (shared != 1 || !consistent) return {};
    const Vec3 edge = mesh_.positions[to] - mesh_.positions[from];
    const double length = norm(edge);
    for (const std::uint32_t f : {face, other})
      if (!(std::abs(dot(faces_.normal[f], edge)) <= kFlat * length)) return {};
    return {length * length, std::min(face, other), std::max(face, other)};
  }

  // The neighbour without a partner across the side that saves most.
  [[nodiscard]] std::uint32_t best(std::uint32_t face) const {
    std::uint32_t best = kNone;
    Saving most;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t other = faces_.neighbours[face][k];
      if (other == kNone || partner_[other] != kNone) continue;
      if (const Saving s = saving(face, k); s > most) std::tie(most, best) = std::tie(s, other);
    }
    return best;
  }

  const Mesh& mesh_;
  const FaceGeometry& faces_;
  std::vector<std::uint32_t> partner_, choice_;
};

}  // namespace

std::vector<Chart> pair_faces(const Mesh& mesh, const FaceGeometry& faces) {
  Matching matching(mesh, faces);
  matching.match_dominant();
  matching.augment();
  std::vector<Chart> charts;
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    if (!(faces.area[f] > 0)) continue;
    const std::uint32_t other = matching.partner(f);
    if (other == kNone)
      charts.push_back({faces.normal[f], {f}});
    else if (f < other)
      charts.push_back({faces.normal[f], {f, other}, true});
  }
  return charts;
}

}  // namespace sdm::atlas
