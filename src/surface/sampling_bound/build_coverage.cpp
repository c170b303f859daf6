// The pieces of a surface in the order in which a Coverage uses them: run after run, in each face after face.
#include <algorithm>
#include <numeric>
#include <ranges>

#include "core/parallel.h"
#include "surface/sample_blocks.h"
#include "surface/sampling_bound/coverage.h"
#include "surface/sampling_bound/cut_faces.h"
#include "surface/surface_data.h"

namespace sdm::surface {
namespace {

struct SortedPieces {
  std::vector<FacePiece> pieces;
  std::vector<std::size_t> run_begins;  ///< and the end of the last

  [[nodiscard]] std::span<FacePiece> of_run(std::size_t run) {
    return std::span(pieces).subspan(run_begins[run], run_begins[run + 1] - run_begins[run]);
  }
};

SortedPieces sort_by_run(std::vector<std::vector<FacePiece>> blocks, std::size_t runs) {
  const auto run_of = [](const FacePiece& p) { return p.piece.sample / kRunLength; };
  SortedPieces sorted;
  std::vector<std::size_t>& begins = sorted.run_begins;
  begins.assign(runs + 1, 0);
  for (const auto& block : blocks)
    for (const FacePiece& p : block) ++begins[run_of(p)];
  std::inclusive_scan(begins.begin(), begins.end(), begins.begin());
  sorted.pieces.resize(begins.back());
  for (auto& block : blocks) {
    for (const FacePiece& p : block) sorted.pieces[--begins[run_of(p)]] = p;
    block = {};
  }
  parallel_for(runs, 64, [&](std::size_t first, std::size_t end) {
    for (std::size_t r = first; r < end; ++r)
      std::ranges::stable_sort(sorted.of_run(r), {}, &FacePiece::face);
  });
  return sorted;
}

}  // namespace

class CoverageBuilder {
 public:
  CoverageBuilder(const Surface& surface, Coverage& coverage) : surface_(surface), coverage_(coverage) {}

  void build() {
    FacePieces cut = cut_faces(surface_);
    whole_square_ = std::move(cut.whole_square);
    const std::size_t samples = whole_square_.size();
    std::vector<RunPatches> runs(run_count(samples));
    SortedPieces sorted = sort_by_run(std::move(cut.blocks), runs.size());
    parallel_for(runs.size(), 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t r = begin; r < end; ++r) runs[r] = find_patches({r, samples}, sorted.of_run(r));
    });
    for (std::size_t r = 0; r < runs.size(); ++r) append(runs[r], sorted.of_run(r));
    coverage_.patches_.shrink_to_fit();
  }

 private:
  using Patch = Coverage::Patch;

  /// Those of one run; their ends count from its first.
  struct RunPatches {
    std::vector<Patch> patches;
    std::vector<std::uint8_t> squares;
  };

  [[nodiscard]] RunPatches find_patches(const SampleBlock& run, std::span<const FacePiece> pieces) const {
    std::array<std::pair<std::uint32_t, std::uint8_t>, kRunLength> by_face;
    const std::span samples(by_face.data(), run.size());
    for (std::size_t i = 0; i < samples.size(); ++i)
      samples[i] = {internals(surface_).sample_faces[run.first + i], static_cast<std::uint8_t>(i)};
    std::ranges::sort(samples);
    RunPatches found;
    for (std::size_t s = 0, p = 0; s < samples.size() || p < pieces.size();) {
      Patch patch;
      patch.face =
          std::min(s < samples.size() ? samples[s].first : kNone, p < pieces.size() ? pieces[p].face : kNone);
      for (; s < samples.size() && samples[s].first == patch.face; ++s) {
        const std::size_t sample = run.first + samples[s].second;
        extend(patch, surface_.sample_texels()[sample]);
        if (whole_square_[sample]) found.squares.push_back(samples[s].second);
      }
      for (; p < pieces.size() && pieces[p].face == patch.face; ++p) extend(patch, pieces[p].piece);
      patch.square_end = static_cast<std::uint32_t>(found.squares.size());
      patch.piece_end = static_cast<std::uint32_t>(p);
      found.patches.push_back(patch);
    }
    return found;
  }

  void extend(Patch& patch, std::uint32_t texel) const {
    const std::uint32_t n = surface_.resolution();
    const std::array at{static_cast<std::uint16_t>(texel % n), static_cast<std::uint16_t>(texel / n)};
    for (int i = 0; i < 2; ++i) {
      patch.low_texel[i] = std::min(patch.low_texel[i], at[i]);
      patch.high_texel[i] = std::max(patch.high_texel[i], at[i]);
    }
  }

  static void extend(Patch& patch, const Piece& piece) {
    for (int i = 0; i < 2; ++i) {
      patch.low_weights[i] = std::min(patch.low_weights[i], std::ranges::min(piece.weights[i]));
      patch.high_weights[i] = std::max(patch.high_weights[i], std::ranges::max(piece.weights[i]));
    }
  }

  void append(const RunPatches& run, std::span<const FacePiece> pieces) {
    auto& [run_ends, patches, squares, all_pieces] = coverage_;
    const auto first_square = static_cast<std::uint32_t>(squares.size());
    const auto first_piece = static_cast<std::uint32_t>(all_pieces.size());
    for (Patch patch : run.patches) {
      patch.square_end += first_square;
      patch.piece_end += first_piece;
      patches.push_back(patch);
    }
    run_ends.push_back(static_cast<std::uint32_t>(patches.size()));
    squares.insert(squares.end(), run.squares.begin(), run.squares.end());
    for (Piece piece : pieces | std::views::transform(&FacePiece::piece)) {
      piece.sample %= kRunLength;
      all_pieces.push_back(piece);
    }
  }

  const Surface& surface_;
  Coverage& coverage_;
  std::vector<std::uint8_t> whole_square_;  ///< as of FacePieces
};

Coverage::Coverage(const Surface& surface) {
  CoverageBuilder(surface, *this).build();
}

}  // namespace sdm::surface
