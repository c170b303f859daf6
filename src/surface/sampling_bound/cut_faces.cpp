// Cuts the faces into pieces and assigns each piece to a sample. Any assignment gives valid radii; a good one
// gives small radii, now and after the surface has deformed. Faces are cut along the squares of the texels.
// Where a face owns a square, the sample is the square's centre.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/geometry/vec.h"
#include "core/parallel.h"
#include "surface/sampling_bound/cut_faces.h"
#include "surface/sampling_bound/near_samples.h"
#include "surface/sampling_bound/piece_assignment.h"
#include "surface/sampling_bound/polygon.h"
#include "surface/surface_data.h"

namespace sdm::surface {
namespace {

/// A sample within this many half diagonals is near enough: points across an edge may be as far as its
/// square.
constexpr double kNearEnough = 1.1;

std::array<Vec3, 3> vertices_of(const Mesh& mesh, std::size_t face) {
  const auto& [a, b, c] = mesh.triangles[face];
  return {mesh.positions[a], mesh.positions[b], mesh.positions[c]};
}

/// Half the diagonal of a square texel, if all the area were shared among the samples.
double typical_radius(const Surface& surface) {
  double doubled_area = 0;
  for (std::size_t f = 0; f < surface.mesh().triangles.size(); ++f) {
    const auto [a, b, c] = vertices_of(surface.mesh(), f);
    doubled_area += norm(cross(b - a, c - a));
  }
  return 0.5 * std::sqrt(doubled_area / static_cast<double>(surface.sample_texels().size()));
}

/// A face without area is its longest edge, up to its height. It is represented by a triangle in the plane
/// whose base is as many squares long as it should have pieces.
std::array<Vec2, 3> unfolded(const std::array<Vec3, 3>& vertices, double piece_length) {
  constexpr double kMostPieces = 1024;
  const auto edge = [&](int k) { return vertices[(k + 1) % 3] - vertices[k]; };
  int base = 0;  // the longest edge runs from this vertex to the next
  for (int k = 1; k < 3; ++k)
    if (squared_norm(edge(k)) > squared_norm(edge(base))) base = k;
  const double length = norm(edge(base));
  const double pieces = std::clamp(std::ceil(length / piece_length), 1.0, kMostPieces);
  const double foot = length > 0 ? -dot(edge((base + 2) % 3), edge(base)) / (length * length) : 0;
  std::array<Vec2, 3> triangle{};
  triangle[(base + 1) % 3] = {pieces, 0};
  triangle[(base + 2) % 3] = {std::clamp(foot, 0.0, 1.0) * pieces, 0.5};
  return triangle;
}

class Cutter {
 public:
  explicit Cutter(const Surface& surface)
      : surface_(surface), typical_(typical_radius(surface)), near_samples_(surface, typical_) {
    const std::span<const std::uint32_t> samples = surface.sample_texels(), owners = surface.texel_faces();
    owns_texel_.assign(surface.mesh().triangles.size(), 0);
    sample_of_.resize(owners.size());
    result_.whole_square.assign(samples.size(), 1);
    for (std::uint32_t i = 0; i < samples.size(); ++i) {
      sample_of_[samples[i]] = i;
      owns_texel_[owners[samples[i]]] = 1;
    }
  }

  FacePieces operator()() {
    constexpr std::size_t kFacesPerGroup = 64;
    // In the order of the charts, so that lookups are local.
    const std::span<const std::uint32_t> charts = surface_.face_charts();
    std::vector<std::uint32_t> order(charts.size());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::stable_sort(order, {}, [&](std::uint32_t face) { return charts[face]; });
    std::vector<std::vector<FacePiece>>& groups = result_.face_groups;
    groups.resize((order.size() + kFacesPerGroup - 1) / kFacesPerGroup);
    parallel_for(groups.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin * kFacesPerGroup; i < std::min(end * kFacesPerGroup, order.size()); ++i)
        cut(order[i], groups[i / kFacesPerGroup]);
    });
    return std::move(result_);
  }

 private:
  using Pieces = std::vector<FacePiece>;

  struct Face {
    std::uint32_t index;
    std::array<Vec3, 3> vertices;
    double enough;  ///< a distance from a piece to its sample that needs no improvement
  };

  void cut(std::uint32_t index, Pieces& pieces) {
    const std::array<Vec3, 3> vertices = vertices_of(surface_.mesh(), index);
    const double radius = owns_texel_[index] ? half_diagonal(surface_.texel_edges(index)) : typical_;
    const Face face{index, vertices, kNearEnough * radius};
    surface_.face_charts()[index] == kNone ? add_face_without_area(pieces, face) : add_face(pieces, face);
  }

  void add_face_without_area(Pieces& pieces, const Face& face) {
    for_each_square(unfolded(face.vertices, typical_), [&](double, double, SquareCorners, const auto& part) {
      if (const Polygon polygon = part(); !polygon.empty())
        store(pieces, face, polygon, near_samples_.nearest_texel(Outline(face.vertices, polygon)));
    });
  }

  void add_face(Pieces& pieces, const Face& face) {
    const auto visit = [&](double x, double y, SquareCorners corners, const auto& part) {
      const std::uint32_t texel = near_samples_.texel_at(x, y);
      const bool owned = texel != kNone && surface_.texel_faces()[texel] == face.index;
      if (owned && corners.both_diagonals()) return;
      const Polygon polygon = part();
      if (polygon.empty()) return;
      if (owned) {
        result_.whole_square[sample_of_[texel]] = 0;
        store(pieces, face, polygon, texel);
      } else {
        add_piece(pieces, face, {x, y}, polygon, 0);
      }
    };
    for_each_square(internals(surface_).corners[face.index], visit);
  }

  /// Adds a piece in the square with this upper left corner, which its face does not own. A piece that is far
  /// from every sample because it is large is halved.
  void add_piece(Pieces& pieces, const Face& face, const Vec2& square, const Polygon& polygon, int cuts) {
    constexpr int kMostCuts = 4;
    constexpr std::size_t kMostCorners = 8;  // cutting a polygon of 8 gives at most 12
    const Outline outline(face.vertices, polygon);
    const auto [texel, distance] =
        near_samples_.choose(face.index, square[0], square[1], outline, face.enough);
    const bool large = 4 * outline.farthest_from(outline.middle()) > distance;
    if (distance <= face.enough || !large || cuts == kMostCuts || polygon.corners().size() > kMostCorners)
      return store(pieces, face, polygon, texel);
    const auto [left, right] = polygon.range(0);
    const auto [top, bottom] = polygon.range(1);
    const bool wide = right - left > bottom - top;
    const double middle = wide ? 0.5 * (left + right) : 0.5 * (top + bottom);
    for (const double side : {1.0, -1.0})
      if (const Polygon half = polygon.clipped(wide ? 0 : 1, middle, side); !half.empty())
        add_piece(pieces, face, square, half, cuts + 1);
  }

  void store(Pieces& pieces, const Face& face, const Polygon& polygon, std::uint32_t texel) const {
    const auto corners = polygon.corners();
    for (std::size_t first = 0; first < corners.size(); first += 4) {
      Piece& piece = pieces.emplace_back(FacePiece{face.index, {}}).piece;
      piece.sample = sample_of_[texel];
      for (std::size_t k = 0; k < 4; ++k)
        for (int i = 0; i < 2; ++i)
          piece.weights[i][k] =
              static_cast<float>(corners[std::min(first + k, corners.size() - 1)].weights[i]);
    }
  }

  const Surface& surface_;
  const double typical_;
  const NearSamples near_samples_;
  FacePieces result_;
  std::vector<std::uint32_t> sample_of_;  ///< of each texel that a face owns
  std::vector<std::uint8_t> owns_texel_;  ///< whether each face does
};

}  // namespace

FacePieces cut_faces(const Surface& surface) {
  return Cutter(surface)();
}

}  // namespace sdm::surface
