// The volume of a solid, from the parts of its boundary.
#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "inside/solid_boundary.h"
#include "sites/sites_data.h"

namespace sdm::inside {
namespace {

constexpr std::size_t kRun = 256;
// The work of dividing, in comparisons of two triangles, that a volume has for each face: far more than where
// faces cross few others.
constexpr std::size_t kWorkOfEachFace = 20'000;

}  // namespace

// The volume by a run of faces, by the divergence theorem: V = Σ a·(b × c) / 6 over triangles abc of the
// boundary. Largest pieces first.
class SolidBoundary::VolumeSum {
 public:
  // Six times the volume, and what the parts that may or may not be boundary contribute.
  double sure = 0, unsure = 0;

  VolumeSum(const SolidBoundary& boundary, std::span<const std::uint32_t> faces)
      : boundary_(boundary), work_left_(kWorkOfEachFace * faces.size()), windings_(faces.size()) {
    for (std::uint32_t i = 0; i < faces.size(); ++i) add(boundary.whole_face(faces[i]), i, kNone);
  }

  // Divides pieces within the budget of work, which does not depend on the number of threads.
  void divide() {
    Division division;
    while (!open_.empty()) {
      const Open next = open_.front();
      std::ranges::pop_heap(open_, {}, &Open::size);
      open_.pop_back();
      if (work_left_ == 0) {
        unsure += next.size;
        continue;
      }
      const Piece& piece = next.piece;
      boundary_.divide(piece, near_of(piece.face, next.within), windings_[next.number], division);
      work_left_ -= std::min(work_left_, division.work);
      const auto number = static_cast<std::uint32_t>(near_.size());
      near_.push_back(division.near);
      for (const Piece& part : division.pieces) add(part, next.number, number);
    }
  }

 private:
  struct Open {
    double size = 0;  // its part of the sum, without its sign
    Piece piece;
    std::uint32_t number = 0;      // of its face, in this run
    std::uint32_t within = kNone;  // the number in near_ of the piece that it is a part of
  };

  [[nodiscard]] std::span<const std::uint32_t> near_of(std::uint32_t face, std::uint32_t within) const {
    return within == kNone ? boundary_.mixed(face).near : near_[within];
  }
  // `within`: kNone for a whole face.
  void add(const Piece& piece, std::uint32_t number, std::uint32_t within) {
    if (piece.sides == Sides::buried || repeats_earlier_face(piece, within)) return;
    const auto& [a, b, c] = piece.at;
    const double flux = dot(a, cross(b, c)) * (boundary_.solid_.inverted[piece.face] ? -1 : 1);
    if (piece.sides == Sides::unknown && !boundary_.solid_.sliver[piece.face]) {
      open_.push_back({std::abs(flux), piece, number, within});
      std::ranges::push_heap(open_, {}, &Open::size);
    } else if (piece.sides == Sides::boundary || piece.sides == Sides::reversed) {
      sure += piece.sides == Sides::boundary ? flux : -flux;
    } else {
      unsure += std::abs(flux);
    }
  }
  // A piece that lies in an earlier face counts there, whatever its sides are.
  bool repeats_earlier_face(const Piece& piece, std::uint32_t within) {
    if (boundary_.sides_[piece.face] != Sides::mixed) return false;
    const std::span<const std::uint32_t> near = near_of(piece.face, within);
    work_left_ -= std::min(work_left_, near.size());
    return boundary_.repeats_earlier_face(piece, near);
  }

  const SolidBoundary& boundary_;
  std::size_t work_left_;
  std::vector<Windings> windings_;                // of each face
  std::vector<Open> open_;                        // a heap
  std::vector<std::vector<std::uint32_t>> near_;  // of each divided piece
};

SolidBoundary::Volume SolidBoundary::volume() const {
  const Array<std::uint32_t>& faces = solid_.tree.items;
  // Partial sums that do not depend on the number of threads.
  struct Sum {
    double sure = 0, unsure = 0;
  };
  std::vector<Sum> sums((faces.size() + kRun - 1) / kRun);
  parallel_for(sums.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      VolumeSum sum(*this, std::span(faces).subspan(kRun * i).first(std::min(kRun, faces.size() - kRun * i)));
      sum.divide();
      sums[i] = {sum.sure, sum.unsure};
    }
  });
  Sum all;
  for (const Sum& sum : sums) {
    all.sure += sum.sure;
    all.unsure += sum.unsure;
  }
  const double unit = 1 / (6 * solid_.frame.scale * solid_.frame.scale * solid_.frame.scale);
  return {unit * std::max(0.0, all.sure - all.unsure), unit * (all.sure + all.unsure)};
}

}  // namespace sdm::inside
