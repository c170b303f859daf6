#include "query/inside/solid_angles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "core/cancellation.h"
#include "geometry/vec.h"
#include "tree/fold.h"

namespace sdm::inside {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
// The rounding of expansions, and of the sums of terms and of their errors.
constexpr double kSumRounding = 1e-12;
// Terms with larger errors, in solid angle, are never part of a sum: its error stays accurate when they are
// taken out again.
constexpr double kMostError = 1;

}  // namespace

void SolidAngles::add(Node& sum, const Node& part) {
  // About the centre of the sum, which is set before its parts are added.
  const Vec3 d = part.centre - sum.centre;
  const Vec3& m = part.moment;
  const std::array<double, 6> moved{d[0] * m[0],
                                    d[1] * m[1],
                                    d[2] * m[2],
                                    0.5 * (d[0] * m[1] + d[1] * m[0]),
                                    0.5 * (d[1] * m[2] + d[2] * m[1]),
                                    0.5 * (d[2] * m[0] + d[0] * m[2])};
  for (std::size_t i = 0; i < moved.size(); ++i) sum.first[i] += part.first[i] + moved[i];
  sum.moment += m;
  sum.second += part.second + part.area * squared_norm(d);
}

SolidAngles::Node SolidAngles::of_face(std::uint32_t face) const {
  const auto [a, b, c] = faces_.corners(face);
  Node node;
  node.centre = (1.0 / 3) * (a + b + c);
  node.moment = 0.5 * cross(b - a, c - a);
  node.area = norm(node.moment);
  node.second = node.area / 36 * (squared_norm(b - a) + squared_norm(c - b) + squared_norm(a - c));
  return node;
}

Vec3 SolidAngles::middle(const tree::FloatBox& box) const {
  const Vec3 lo{box.lo[0], box.lo[1], box.lo[2]}, hi{box.hi[0], box.hi[1], box.hi[2]};
  return faces_.faces.frame.origin + (0.5 / faces_.faces.frame.scale) * (lo + hi);
}

// Sets the radius to the distance of the box's farthest corner.
void SolidAngles::finish(Node& node, const tree::FloatBox& box) const {
  const Vec3 centre = middle(box);
  Vec3 farthest;
  for (int k = 0; k < 3; ++k)
    farthest[k] = 0.5 / faces_.faces.frame.scale * (double{box.hi[k]} - box.lo[k]) +
                  std::abs(node.centre[k] - centre[k]);
  node.radius = norm(farthest);
}

SolidAngles::SolidAngles(const OrientedFaces& faces) : faces_(faces), nodes_(faces.faces.tree.nodes.size()) {
  const tree::AabbTree& tree = faces_.faces.tree;
  const auto sum = [&](Node& node, std::span<const Node> parts, std::uint32_t index) {
    for (const Node& part : parts) node.area += part.area, node.centre += part.area * part.centre;
    node.centre = node.area > 0 ? (1 / node.area) * node.centre : middle(tree.box(index));
    for (const Node& part : parts) add(node, part);
    finish(node, tree.box(index));
  };
  Poll due(1024);
  std::vector<Node> of_leaf;
  for_each_bottom_up(
      tree,
      [&](std::uint32_t leaf) {
        due();
        of_leaf.clear();
        for (const std::uint32_t face : tree.items_of(leaf)) of_leaf.push_back(of_face(face));
        sum(nodes_[leaf], of_leaf, leaf);
      },
      [&](std::uint32_t node, std::uint32_t left, std::uint32_t right) {
        sum(nodes_[node], std::array{nodes_[left], nodes_[right]}, node);
      });
}

/// The expansion of a node, as part of a sum.
struct SolidAngles::Term {
  double value = 0, error = 0;
  std::uint32_t node = 0;
  double gap = 0;
};

/// The sum at one point while it is refined.
class SolidAngles::Refinement {
 public:
  Refinement(const SolidAngles& angles, const Vec3& q, std::vector<Term>& terms)
      : angles_(angles), q_(q), unit_(angles.faces_.faces.frame.to_unit(q)), terms_(terms) {
    terms_.clear();
    take(0);
  }

  /// Replaces the term of the largest error by its children; false if there is none.
  bool refine() {
    if (terms_.empty()) return false;
    std::ranges::pop_heap(terms_, {}, &Term::error);
    const Term term = terms_.back();
    terms_.pop_back();
    sum_.value -= term.value, sum_.error -= term.error;
    open(term.node);
    return true;
  }
  [[nodiscard]] SolidAngle sum() const { return {sum_.value, std::max(sum_.error, 0.0) + kSumRounding}; }
  /// How far q can move while the sum changes by less than `change`. No term changes by more than 2·A/g³ per
  /// length, where g is the distance to its faces on the way, at least 3/4 of that from q.
  [[nodiscard]] double reach(double change) const {
    double nearest = nearest_leaf_, steepest = steepness_of_leaves_;
    for (const Term& term : terms_) {
      nearest = std::min(nearest, term.gap);
      steepest += angles_.nodes_[term.node].area / (term.gap * term.gap * term.gap);
    }
    return std::min(0.25 * nearest, change * (27.0 / 64) / (2 * steepest));
  }

 private:
  void open(std::uint32_t index) {
    const tree::AabbTree::Node& node = angles_.faces_.faces.tree.nodes[index];
    if (node.leaf()) return add_faces(index);
    take(index + 1);
    take(node.right);
  }
  // Adds the expansion of a node, or opens it if the error would be large.
  void take(std::uint32_t index) {
    const Node& node = angles_.nodes_[index];
    const Vec3 r = node.centre - q_;
    const double squared = squared_norm(r), distance = std::sqrt(squared), gap = distance - node.radius;
    if (!(gap > 0)) return open(index);
    const double cube = gap * gap * gap;
    const double zeroth = 2 * node.area * node.radius / cube, first = 3 * node.second / (cube * gap);
    Term term{0, std::min(zeroth, first), index, gap};
    if (!(term.error < kMostError)) return open(index);
    const double inverse = 1 / (squared * distance);
    term.value = dot(node.moment, r) * inverse;
    if (first < zeroth) {
      const auto& [xx, yy, zz, xy, yz, zx] = node.first;
      const double along = r[0] * (xx * r[0] + 2 * xy * r[1]) + r[1] * (yy * r[1] + 2 * yz * r[2]) +
                           r[2] * (zz * r[2] + 2 * zx * r[0]);
      term.value += inverse * (xx + yy + zz - 3 * along / squared);
    }
    sum_.value += term.value, sum_.error += term.error;
    terms_.push_back(term);
    std::ranges::push_heap(terms_, {}, &Term::error);
  }
  void add_faces(std::uint32_t leaf) {
    const FaceTree& faces = angles_.faces_.faces;
    for (const std::uint32_t face : faces.tree.items_of(leaf)) {
      const auto [a, b, c] = angles_.faces_.corners(face);
      const SolidAngle angle = bounded_solid_angle(a - q_, b - q_, c - q_);
      sum_.value += angle.value, sum_.error += angle.error;
    }
    const double gap = norm(tree::gap(faces.tree.box(leaf), unit_)) / faces.frame.scale;
    nearest_leaf_ = std::min(nearest_leaf_, gap);
    steepness_of_leaves_ += gap > 0 ? angles_.nodes_[leaf].area / (gap * gap * gap) : kInfinite;
  }

  const SolidAngles& angles_;
  const Vec3& q_;
  Vec3 unit_;  ///< q in the frame of the tree
  std::vector<Term>& terms_;
  SolidAngle sum_;
  double nearest_leaf_ = kInfinite, steepness_of_leaves_ = 0;
};

SolidAngles::Sum SolidAngles::at(const Vec3& q, double limit, double tolerance) const {
  if (nodes_.empty()) return {{}, kInfinite};
  thread_local std::vector<Term> terms;
  Refinement refinement(*this, q, terms);
  for (Poll due(1024);; due()) {
    const SolidAngle angle = refinement.sum();
    const double from_limit = std::abs(angle.value - limit);
    const bool enough = from_limit > 2 * angle.error || angle.error <= tolerance || angle.error == kInfinite;
    if (enough || !refinement.refine()) {
      const double change = from_limit - angle.error;
      return {angle, change > 0 ? refinement.reach(change) : 0};
    }
  }
}

}  // namespace sdm::inside
