#include "query/inside/solid_angles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "core/cancellation.h"
#include "core/numbers/compensated_sum.h"
#include "geometry/rounding.h"
#include "geometry/vec.h"
#include "tree/fold.h"

namespace sdm::inside {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
// Terms with larger errors, in solid angle, are never part of a sum.
constexpr double kMostError = 1;
// Bounds of solid_angles.h: δ relative to lengths, and the rounding of terms relative to P/g².
constexpr double kDisplacement = 16 * kHalfUlp, kTermRounding = 256 * kHalfUlp;
// A bound that is computed from other bounds may be smaller by a fraction of less than this.
constexpr double kBoundRounding = 1e-6;

// The error of terms on the next pass. Where a surface is divided until the terms have the error e, their
// number is as 1/√e, and so is the sum of their errors as √e.
double next_error(double most, double wanted, double sum) {
  constexpr double kLeast = 1e-14;  // near rounding: then no term is left
  const double factor = wanted / sum;
  const double next = most * std::clamp(factor * factor, 1.0 / 64, 0.5);
  return next < kLeast ? 0 : next;
}

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
  const Vec3& origin = faces_.faces.frame.origin;
  Node node;
  node.centre = (1.0 / 3) * ((a - origin) + (b - origin) + (c - origin));
  node.moment = 0.5 * cross(b - a, c - a);
  node.area = norm(node.moment);
  node.second = node.area / 36 * (squared_norm(b - a) + squared_norm(c - b) + squared_norm(a - c));
  node.edges = norm(b - a) * norm(c - a);
  return node;
}

// To the farthest corner of the box.
double SolidAngles::radius_by_box(const Vec3& centre, const tree::FloatBox& box) const {
  Vec3 farthest;
  for (int k = 0; k < 3; ++k) {
    const double lo = unit_ * box.lo[k] - centre[k], hi = unit_ * box.hi[k] - centre[k];
    farthest[k] = std::max(std::abs(lo), std::abs(hi));
  }
  return norm(farthest);
}

double SolidAngles::radius_of_leaf(const Vec3& centre, std::uint32_t leaf) const {
  double squared = 0;
  for (const std::uint32_t face : faces_.faces.tree.items_of(leaf))
    for (const std::uint32_t v : faces_.faces.triangles[face])
      squared =
          std::max(squared, squared_norm((faces_.faces.positions[v] - faces_.faces.frame.origin) - centre));
  return std::sqrt(squared);
}

// The mean of the centres of what is added, by area; `node` has their sum.
void SolidAngles::set_centre(Node& node, const tree::FloatBox& box) const {
  if (node.area > 0) {
    node.centre = (1 / node.area) * node.centre;
    return;
  }
  for (int k = 0; k < 3; ++k) node.centre[k] = 0.5 * unit_ * (double{box.lo[k]} + box.hi[k]);
}

SolidAngles::SolidAngles(const OrientedFaces& faces)
    : faces_(faces), nodes_(faces.faces.tree.nodes.size()), unit_(1 / faces.faces.frame.scale) {
  const tree::AabbTree& tree = faces_.faces.tree;
  const auto sum = [&](Node& node, std::span<const Node> parts, std::uint32_t index) {
    for (const Node& part : parts) {
      node.area += part.area, node.edges += part.edges;
      node.centre += part.area * part.centre;
    }
    set_centre(node, tree.box(index));
    for (const Node& part : parts) add(node, part);
  };
  // The radius covers boxes, whose corners are rounded outwards, and the displacement of faces.
  const auto covering = [&](double radius) {
    return (1 + kProductRounding) * radius + kDisplacement * unit_;
  };
  Poll due(1024);
  std::vector<Node> of_leaf;
  for_each_bottom_up(
      tree,
      [&](std::uint32_t leaf) {
        due();
        of_leaf.clear();
        for (const std::uint32_t face : tree.items_of(leaf)) of_leaf.push_back(of_face(face));
        Node& node = nodes_[leaf];
        sum(node, of_leaf, leaf);
        node.radius = covering(radius_of_leaf(node.centre, leaf));
      },
      [&](std::uint32_t index, std::uint32_t left, std::uint32_t right) {
        Node& node = nodes_[index];
        sum(node, std::array{nodes_[left], nodes_[right]}, index);
        double of_parts = 0;
        for (const std::uint32_t part : {left, right})
          of_parts = std::max(of_parts, norm(nodes_[part].centre - node.centre) + nodes_[part].radius);
        node.radius = covering(std::min(of_parts, radius_by_box(node.centre, tree.box(index))));
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
  /// Uses the memory of `terms` and `opened`.
  Refinement(const SolidAngles& angles, const Vec3& q, std::vector<Term>& terms,
             std::vector<std::uint32_t>& opened)
      : angles_(angles),
        q_(q),
        from_origin_(q - angles.faces_.faces.frame.origin),
        displacement_(kDisplacement * (angles.unit_ + norm(from_origin_))),
        terms_(terms),
        opened_(opened) {
    terms_.clear();
    terms_.push_back({0, kInfinite, 0, 0});
  }

  /// Replaces all terms with errors above `most` by those of their parts, or by faces.
  void refine(double most) {
    most_ = most;
    const auto opened = std::ranges::partition(terms_, [&](const Term& t) { return t.error <= most; });
    opened_.clear();
    for (const Term& term : opened) opened_.push_back(term.node);
    terms_.erase(opened.begin(), opened.end());
    for (const std::uint32_t node : opened_) open(node);
  }
  [[nodiscard]] bool by_faces() const { return terms_.empty(); }

  [[nodiscard]] SolidAngle sum() const {
    const SolidAngle faces = faces_.sum();
    CompensatedSum sum;
    sum += faces.value;
    double error = faces.error, magnitude = std::abs(faces.value);
    for (const Term& term : terms_) sum += term.value, error += term.error, magnitude += std::abs(term.value);
    const double few = kHalfUlp * static_cast<double>(terms_.size() + 1);
    return {sum.value(), (1 + kBoundRounding) * error + (4 * kHalfUlp + 2 * few * few) * magnitude};
  }
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
    const Vec3 r = node.centre - from_origin_;
    const double squared = squared_norm(r), distance = std::sqrt(squared);
    const double gap = (1 - kProductRounding) * distance - node.radius - displacement_;
    if (!(gap > 0)) return open(index);
    const double inverse_gap = 1 / (gap * gap), inverse = 1 / (squared * distance);
    const double remainder = node.second * (3 * distance - 2 * node.radius) * inverse * inverse_gap;
    const double rounding = (kTermRounding * node.edges + 2 * displacement_ * node.area / gap) * inverse_gap;
    Term term{0, remainder + rounding, index, gap};
    if (!(term.error <= most_)) return open(index);
    const auto& [xx, yy, zz, xy, yz, zx] = node.first;
    const double along = r[0] * (xx * r[0] + 2 * xy * r[1]) + r[1] * (yy * r[1] + 2 * yz * r[2]) +
                         r[2] * (zz * r[2] + 2 * zx * r[0]);
    term.value = inverse * (dot(node.moment, r) + xx + yy + zz - 3 * along / squared);
    terms_.push_back(term);
  }
  void add_faces(std::uint32_t leaf) {
    const FaceTree& faces = angles_.faces_.faces;
    for (const std::uint32_t face : faces.tree.items_of(leaf)) {
      const auto [a, b, c] = angles_.faces_.corners(face);
      faces_.add(a - q_, b - q_, c - q_);
    }
    const double gap =
        norm(tree::gap(faces.tree.box(leaf), faces.frame.scale * from_origin_)) / faces.frame.scale;
    nearest_leaf_ = std::min(nearest_leaf_, gap);
    steepness_of_leaves_ += gap > 0 ? angles_.nodes_[leaf].area / (gap * gap * gap) : kInfinite;
  }

  const SolidAngles& angles_;
  const Vec3& q_;
  Vec3 from_origin_;     ///< q relative to the origin of the frame
  double displacement_;  ///< δ
  double most_ = 0;
  std::vector<Term>& terms_;
  std::vector<std::uint32_t>& opened_;
  SolidAngleSum faces_;
  double nearest_leaf_ = kInfinite, steepness_of_leaves_ = 0;
};

SolidAngles::Sum SolidAngles::at(const Vec3& q, double limit, double tolerance) const {
  if (nodes_.empty()) return {{}, kInfinite};
  thread_local std::vector<Term> terms;
  thread_local std::vector<std::uint32_t> opened;
  Refinement refinement(*this, q, terms, opened);
  for (double most = kMostError;;) {
    refinement.refine(most);
    poll();
    const SolidAngle angle = refinement.sum();
    const double from_limit = std::abs(angle.value - limit);
    if (from_limit > 2 * angle.error || angle.error <= tolerance || angle.error == kInfinite ||
        refinement.by_faces()) {
      const double change = from_limit - angle.error;
      return {angle, change > 0 ? refinement.reach(change) : 0};
    }
    most = next_error(most, std::max(tolerance, 0.5 * from_limit), angle.error);
  }
}

}  // namespace sdm::inside
