// Sorts the pieces of a surface into the order in which a PieceAssignment uses them: by block, then by face.
#include <sdm/error.h>

#include <algorithm>
#include <numeric>

#include "core/parallel.h"
#include "surface/sample_blocks.h"
#include "surface/sampling_bound/cut_faces.h"
#include "surface/sampling_bound/piece_assignment.h"
#include "surface/surface_data.h"

namespace sdm::surface {
namespace {

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

}  // namespace sdm::surface
