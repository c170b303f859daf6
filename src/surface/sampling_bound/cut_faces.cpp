#include "surface/sampling_bound/cut_faces.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/parallel.h"
#include "surface/sampling_bound/face_cutter.h"

namespace sdm::surface {
namespace {

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

}  // namespace

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

}  // namespace sdm::surface
