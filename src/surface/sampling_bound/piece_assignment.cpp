#include "surface/sampling_bound/piece_assignment.h"

#include <sdm/error.h>
#include <sdm/surface.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "core/atomic_extremes.h"
#include "core/parallel.h"
#include "surface/sample_order.h"
#include "surface/sampling_bound/face_cutter.h"
#include "surface/sampling_bound/measure_pieces.h"
#include "surface/sampling_bound/sample_tree.h"
#include "surface/surface_data.h"

namespace sdm::surface {

float rounded_up(double x) {
  return static_cast<float>(x * (1 + 0x1p-23));
}

double half_diagonal(const std::array<Vec3, 2>& texel_edges) {
  const auto& [du, dv] = texel_edges;
  return 0.5 * std::sqrt(std::max(squared_norm(du + dv), squared_norm(du - dv)));
}

double square_radius(const Surface& surface, std::uint32_t face, const FaceFrame& frame) {
  const atlas::FaceMap& map = internals(surface).maps[face];
  const auto& [du, dv] = map.edges;
  double mismatch = 0;
  for (int k = 0; k < 2; ++k) {
    const Vec2 d = internals(surface).corners[face][k + 1] - map.origin;
    mismatch = std::max(mismatch, norm(d[0] * du + d[1] * dv - frame.edges[k]));
  }
  return half_diagonal(map.edges) + mismatch + frame.rounding();
}

// Calls take_face(face, radius) for each face in the block: no point of its pieces here is farther from its
// sample.
template <class Take>
void PieceAssignment::measure_block(const Surface& surface, std::size_t block, std::span<const Vec3> points,
                                    std::span<float> radii, const Take& take_face) const {
  std::ranges::fill(radii, 0.0f);
  for_each_face(block, [&](const FaceInBlock& part, auto squares, std::span<const Piece> pieces) {
    const FaceFrame frame(surface.mesh(), part.face);
    float largest = 0;
    if (!squares.empty()) {
      largest = rounded_up(square_radius(surface, part.face, frame));
      for (const std::uint8_t sample : squares) radii[sample] = std::max(radii[sample], largest);
    }
    const double rounding = frame.rounding();
    for (std::array<double, 64> squared; !pieces.empty();) {
      const auto some = pieces.first(std::min(squared.size(), pieces.size()));
      measure_pieces(some, frame.origin, frame.edges, points, squared);
      for (std::size_t i = 0; i < some.size(); ++i) {
        const float radius = rounded_up(std::sqrt(squared[i]) + rounding);
        radii[some[i].sample] = std::max(radii[some[i].sample], radius);
        largest = std::max(largest, radius);
      }
      pieces = pieces.subspan(some.size());
    }
    take_face(part.face, largest);
  });
}

void PieceAssignment::measure(const Surface& surface, Radii& radii) const {
  const std::size_t samples = surface.sample_texels().size();
  radii.faces.assign(surface.mesh().triangles.size(), 0);
  radii.samples.resize(samples);
  const auto take_face = [&](std::uint32_t face, float largest) { atomic_max(radii.faces[face], largest); };
  parallel_for(block_count(samples), 16, [&](std::size_t begin, std::size_t end) {
    std::array<Vec3, kBlockSize> places;
    for (std::size_t b = begin; b < end; ++b) {
      const SampleBlock block(b, samples);
      const std::span points = std::span(places).first(block.size());
      internals(surface).place_samples(block.first, points);
      measure_block(surface, b, points, std::span(radii.samples).subspan(block.first, block.size()),
                    take_face);
    }
  });
  radii.largest = *std::ranges::max_element(radii.faces);
}

namespace {

struct FacePiece {
  std::uint32_t face;
  Piece piece;
};

struct FacePieces {
  /// Each group holds the pieces of a few neighbouring faces. Sample indices are global.
  std::vector<std::vector<FacePiece>> face_groups;
  /// Whether the face of each sample contains an end of each diagonal of its square; no part of such a
  /// square is among the pieces.
  std::vector<std::uint8_t> whole_square;
};

/// Stores the pieces of a group of faces.
class PieceStore {
 public:
  /// `sample_of`: the place of each sample in the order of samples.
  PieceStore(std::span<const std::uint32_t> sample_of, std::vector<FacePiece>& pieces,
             std::span<std::uint8_t> whole_square)
      : sample_of_(sample_of), pieces_(pieces), whole_square_(whole_square) {}

  [[nodiscard]] static double enough(const CutFace& face) { return face.enough; }
  [[nodiscard]] static bool skips(const CutFace&, double, double, std::uint32_t) { return false; }
  void take_whole_square(const CutFace&, std::uint32_t texel) { whole_square_[sample_of_[texel]] = 1; }

  void take_piece(const CutFace& face, const Polygon& polygon, std::uint32_t texel) {
    const auto corners = polygon.corners();
    for (std::size_t first = 0; first < corners.size(); first += 4) {
      Piece& piece = pieces_.emplace_back(FacePiece{face.index, {}}).piece;
      piece.sample = sample_of_[texel];
      for (std::size_t k = 0; k < 4; ++k)
        for (int i = 0; i < 2; ++i)
          piece.weights[i][k] =
              static_cast<float>(corners[std::min(first + k, corners.size() - 1)].weights[i]);
    }
  }

 private:
  std::span<const std::uint32_t> sample_of_;
  std::vector<FacePiece>& pieces_;
  std::span<std::uint8_t> whole_square_;
};

/// Cuts the faces along the squares of the texels, and assigns each piece to a sample that is near it. Cost:
/// linear in texels and pieces, all cores.
FacePieces cut_faces(const Surface& surface) {
  const FaceCutter cutter(surface);
  const std::span<const std::uint32_t> samples = surface.sample_texels();
  std::vector<std::uint32_t> sample_of(surface.map_faces().size());
  for (std::uint32_t i = 0; i < samples.size(); ++i) sample_of[samples[i]] = i;

  constexpr std::size_t kFacesPerGroup = 64;
  // The order of the charts keeps lookups local.
  const std::span<const std::uint32_t> charts = surface.face_charts();
  std::vector<std::uint32_t> order(charts.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t face) { return charts[face]; });
  FacePieces result;
  result.whole_square.assign(samples.size(), 0);
  result.face_groups.resize((order.size() + kFacesPerGroup - 1) / kFacesPerGroup);
  parallel_for(result.face_groups.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin * kFacesPerGroup; i < std::min(end * kFacesPerGroup, order.size()); ++i) {
      if (is_removed(surface.mesh().triangles[order[i]])) continue;
      PieceStore store(sample_of, result.face_groups[i / kFacesPerGroup], result.whole_square);
      cutter.cut(order[i], store);
    }
  });
  return result;
}

struct SortedPieces {
  std::vector<FacePiece> pieces;
  std::vector<std::size_t> block_begins;  ///< and the end of the last

  [[nodiscard]] std::span<FacePiece> of_block(std::size_t block) {
    return std::span(pieces).subspan(block_begins[block], block_begins[block + 1] - block_begins[block]);
  }
};

SortedPieces sort_by_block(std::vector<std::vector<FacePiece>> face_groups, std::size_t blocks) {
  const auto block_of = [](const FacePiece& p) { return p.piece.sample / kBlockSize; };
  SortedPieces sorted;
  std::vector<std::size_t>& begins = sorted.block_begins;
  begins.assign(blocks + 1, 0);
  for (const auto& group : face_groups)
    for (const FacePiece& p : group) ++begins[block_of(p)];
  std::inclusive_scan(begins.begin(), begins.end(), begins.begin());
  sorted.pieces.resize(begins.back());
  for (auto& group : face_groups) {
    for (const FacePiece& p : group) sorted.pieces[--begins[block_of(p)]] = p;
    group = {};
  }
  parallel_for(blocks, 64, [&](std::size_t first, std::size_t end) {
    for (std::size_t b = first; b < end; ++b)
      std::ranges::stable_sort(sorted.of_block(b), {}, &FacePiece::face);
  });
  return sorted;
}

}  // namespace

/// Sorts the pieces of a surface into the order in which a PieceAssignment uses them: by block, then by face.
class PieceAssignmentBuilder {
 public:
  PieceAssignmentBuilder(const Surface& surface, PieceAssignment& result)
      : surface_(surface), result_(result) {}

  void build() {
    FacePieces cut = cut_faces(surface_);
    whole_square_ = std::move(cut.whole_square);
    const std::size_t samples = whole_square_.size();
    std::vector<BlockFaces> blocks(block_count(samples));
    SortedPieces sorted = sort_by_block(std::move(cut.face_groups), blocks.size());
    parallel_for(blocks.size(), 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) blocks[b] = find_faces({b, samples}, sorted.of_block(b));
    });
    for (std::size_t b = 0; b < blocks.size(); ++b) append(blocks[b], sorted.of_block(b));
    result_.faces_in_blocks_.shrink_to_fit();
  }

 private:
  using FaceInBlock = PieceAssignment::FaceInBlock;

  /// The faces of one block; ends are relative to the first of the block.
  struct BlockFaces {
    std::vector<FaceInBlock> faces;
    std::vector<std::uint8_t> squares;
  };

  [[nodiscard]] BlockFaces find_faces(const SampleBlock& block, std::span<const FacePiece> pieces) const {
    std::array<std::pair<std::uint32_t, std::uint8_t>, kBlockSize> by_face;
    const std::span samples(by_face.data(), block.size());
    for (std::size_t i = 0; i < samples.size(); ++i)
      samples[i] = {internals(surface_).sample_faces[block.first + i], static_cast<std::uint8_t>(i)};
    std::ranges::sort(samples);
    BlockFaces found;
    for (std::size_t s = 0, p = 0; s < samples.size() || p < pieces.size();) {
      FaceInBlock part;
      part.face =
          std::min(s < samples.size() ? samples[s].first : kNone, p < pieces.size() ? pieces[p].face : kNone);
      for (; s < samples.size() && samples[s].first == part.face; ++s)
        if (whole_square_[block.first + samples[s].second]) found.squares.push_back(samples[s].second);
      while (p < pieces.size() && pieces[p].face == part.face) ++p;
      part.square_end = static_cast<std::uint32_t>(found.squares.size());
      part.piece_end = static_cast<std::uint32_t>(p);
      found.faces.push_back(part);
    }
    return found;
  }

  void append(const BlockFaces& block, std::span<const FacePiece> pieces) {
    auto& [identity, block_ends, faces, squares, all_pieces] = result_;
    const auto first_square = static_cast<std::uint32_t>(squares.size());
    const auto first_piece = static_cast<std::uint32_t>(all_pieces.size());
    for (FaceInBlock part : block.faces) {
      part.square_end += first_square;
      part.piece_end += first_piece;
      faces.push_back(part);
    }
    block_ends.push_back(static_cast<std::uint32_t>(faces.size()));
    squares.insert(squares.end(), block.squares.begin(), block.squares.end());
    for (const FacePiece& of : pieces) {
      all_pieces.push_back(of.piece);
      all_pieces.back().sample %= kBlockSize;
    }
  }

  const Surface& surface_;
  PieceAssignment& result_;
  std::vector<std::uint8_t> whole_square_;  ///< as of FacePieces
};

PieceAssignment::PieceAssignment(const Surface& surface) : identity_(internals(surface).identity) {
  PieceAssignmentBuilder(surface, *this).build();
}

void PieceAssignment::require_same(const Surface& surface) const {
  if (internals(surface).identity != identity_)
    throw Error(
        "the sampling bound was built for another surface, or before an edit of this one; build it again");
}

namespace {

/// The largest distance from the tested points of one face to the nearest sample.
class Farthest {
 public:
  Farthest(std::span<const Vec3> samples, const SampleTree& tree, double distance = 0)
      : samples_(samples), tree_(tree), distance_(distance) {}

  /// `most` is the distance to some sample, an upper bound.
  void look_at(const Vec3& p, double most = kInfinity) {
    if (most > distance_) distance_ = std::max(distance_, norm(p - samples_[tree_.nearest(p)]));
  }
  [[nodiscard]] double distance() const { return distance_; }

 private:
  const std::span<const Vec3> samples_;
  const SampleTree& tree_;
  double distance_;
};

/// The weights of the corner of a texel's square that is nearest to the middle of a face: in a large face,
/// the four samples nearest to it are equally far.
std::array<double, 2> middle_corner(const std::array<Vec2, 3>& triangle) {
  const Vec2 a = triangle[1] - triangle[0], b = triangle[2] - triangle[0];
  const Vec2 middle = triangle[0] + (1.0 / 3) * (a + b);
  const Vec2 p = Vec2{std::round(middle[0]), std::round(middle[1])} - triangle[0];
  return {cross(p, b) / cross(a, b), cross(a, p) / cross(a, b)};
}

}  // namespace

std::vector<double> PieceAssignment::radius_lower_bounds(const Surface& surface, double bound) const {
  const SampleTree tree(surface, 16 * bound);
  const std::vector<Vec3> points = surface.sample_points();
  std::vector<double> radii(surface.mesh().triangles.size());
  parallel_for(radii.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      if (is_removed(surface.mesh().triangles[f])) continue;
      const FaceFrame frame(surface.mesh(), f);
      Farthest farthest(points, tree);
      if (surface.face_charts()[f] != kNone) {
        const auto [a, b] = middle_corner(internals(surface).corners[f]);
        if (a >= 0 && b >= 0 && a + b <= 1) farthest.look_at(frame.at(a, b));
      }
      for (const auto& [a, b] : {std::pair(0, 0), {1, 0}, {0, 1}}) farthest.look_at(frame.at(a, b));
      radii[f] = std::max(0.0, farthest.distance() - frame.rounding());
    }
  });
  parallel_for(block_ends_.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b)
      for_each_face(b, [&](const FaceInBlock& part, auto, std::span<const Piece> pieces) {
        const FaceFrame frame(surface.mesh(), part.face);
        const std::atomic_ref<double> known(radii[part.face]);
        Farthest farthest(points, tree, known.load(std::memory_order_relaxed));
        for (const auto& [sample, weights] : pieces)
          for (int k = 0; k < 4; ++k) {
            const Vec3 corner = frame.at(weights[0][k], weights[1][k]);
            farthest.look_at(corner, norm(corner - points[b * kBlockSize + sample]));
          }
        atomic_max(radii[part.face], farthest.distance() - frame.rounding());
      });
  });
  return radii;
}

}  // namespace sdm::surface
