// A lower bound on the translations that separate two bodies.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bodies/separate/free_translations.h"
#include "bodies/separate/moved_pair.h"
#include "bodies/shape/posed_body.h"

namespace sdm::separate {

/// Covers a ball about 0 by translations with a collision: the largest such radius is a lower bound.
///
/// With r1 the radius of a ball in O1 about c1, r2 that of one in O2 about c2, of which one may be 0, a
/// point, the bodies overlap after a translation t, and all that differ from it by less than
///   v(t) = r1 + r2 − |c1 + t − c2|.
/// In place of r2 − |c1 + t − c2|, the distance of c1 + t to the surface of O2 can be computed, negative
/// outside, which is more. Cubes of translations are taken by their distance from 0, and divided unless one
/// pair of balls covers them. The distance of the first one that is open at the end is the bound. Memory is
/// reused from pair to pair; results do not depend on it.
class OverlapCover {
 public:
  /// Sets the bodies. `error`: of computed distances, in space.
  void start(const shape::PosedBody& o1, const shape::PosedBody& o2, double error);

  /// Adds a point of a body, in space, that is deep in the other one.
  void add_deep_point(int body, const Vec3& p) { deep_.push_back({{p, 0}, body}); }
  /// The bound by pairs of balls, without a translation.
  [[nodiscard]] double bound_at_origin();
  /// The bound; stops when it is `enough` times the length of the best free translation, or when the search
  /// has taken its budget. Centres of cubes that collide with nothing are free translations.
  [[nodiscard]] double cover(FreeTranslations& free, MovedPair& pair, double enough);

 private:
  /// A ball, or point, of each body: v(t) = radius − |t − centre|.
  struct BallPair {
    Vec3 centre{};
    double radius = 0;
    std::array<std::uint32_t, 2> ball{};
  };
  struct DeepPoint {
    shape::Ball ball;
    int body = 0;
  };
  struct Value {
    double v = 0;
    std::uint32_t pair = 0;
  };
  struct Cube {
    Vec3 centre{};
    double half = 0, least = 0;  ///< least: the distance from 0
    std::uint32_t list = 0;      ///< of the pairs that may matter in it
    [[nodiscard]] double half_diagonal() const;
  };
  /// Pairs, by their numbers, which the parts of a cube share.
  struct PairList {
    std::vector<std::uint32_t> pairs;
    std::uint32_t users = 0;
  };
  /// An empty list with one user.
  [[nodiscard]] std::uint32_t take_list();
  void release(std::uint32_t list);
  [[nodiscard]] double measure(int body, const shape::Ball& ball, const Vec3& translation);
  [[nodiscard]] bool covered_by_pairs(Cube& cube);
  [[nodiscard]] bool covered_by_measuring(const Cube& cube);
  void divide(const Cube& cube, double beyond);
  void learn(const Cube& cube, MovedPair& pair);

  std::array<const shape::PosedBody*, 2> bodies_{};
  std::array<Affine, 2> to_frame_;  ///< from space to the frame of each body
  double error_ = 0;
  std::array<std::vector<shape::Ball>, 2> balls_;  ///< in space
  std::vector<BallPair> pairs_;
  std::vector<DeepPoint> deep_;
  std::vector<Cube> open_;  ///< a heap, the nearest first
  std::vector<PairList> lists_;
  std::vector<std::uint32_t> unused_;  ///< lists without users, the next one last
  std::vector<Value> values_;          ///< of the pairs of a cube, the largest first
  std::size_t measured_ = 0;
};

}  // namespace sdm::separate
