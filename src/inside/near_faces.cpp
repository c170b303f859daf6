#include "inside/near_faces.h"

#include <algorithm>
#include <atomic>
#include <span>
#include <utility>

#include "core/parallel.h"
#include "geometry/rounding.h"
#include "geometry/vec.h"
#include "inside/face_pairs.h"
#include "tree/visit.h"

namespace sdm::inside {
namespace {

// The extent of points along an axis.
template <std::size_t N>
std::pair<double, double> extent(const std::array<Vec3, N>& points, const Vec3& axis) {
  std::pair<double, double> range{dot(points[0], axis), dot(points[0], axis)};
  for (std::size_t i = 1; i < N; ++i) {
    const double along = dot(points[i], axis);
    range = {std::min(range.first, along), std::max(range.second, along)};
  }
  return range;
}

// Triangles that share a corner, as vectors from there to the others: whether a plane through the corner lies
// between both, at an angle of more than kClearAngle from each. Faces that meet in the corner of a block have
// such a plane, though the plane of no face and none along two edges is one. With unit vectors, those of b
// reversed, its best normal is the point of their convex hull that is closest to the origin: the middle of a
// side, or the foot on the plane of three of them.
bool apart_on_both_sides(const std::array<Vec3, 2>& a, const std::array<Vec3, 2>& b,
                         const std::array<double, 4>& length) {
  const std::array<Vec3, 4> w{(1 / length[0]) * a[0], (1 / length[1]) * a[1], (-1 / length[2]) * b[0],
                              (-1 / length[3]) * b[1]};
  const auto separates = [&](const Vec3& normal) {
    const std::array<double, 4> along{dot(w[0], normal), dot(w[1], normal), dot(w[2], normal),
                                      dot(w[3], normal)};
    const double far = kClearAngle * norm(normal);
    const auto [least, most] = std::ranges::minmax(along);
    return least > far || most < -far;
  };
  if (separates(w[0] + w[1] + w[2] + w[3])) return true;  // as a rule
  for (int i = 0; i < 4; ++i)
    for (int j = i + 1; j < 4; ++j) {
      if (separates(w[i] + w[j])) return true;
      for (int k = j + 1; k < 4; ++k)
        if (separates(cross(w[j] - w[i], w[k] - w[i]))) return true;
    }
  return false;
}

// Triangles that share a corner, as vectors from there to the others: whether a plane through the corner
// separates them by kClearAngle.
bool apart_at_corner(const std::array<Vec3, 2>& a, const std::array<Vec3, 2>& b) {
  const std::array<double, 4> length{norm(a[0]), norm(a[1]), norm(b[0]), norm(b[1])};
  const auto separates = [&](const Vec3& axis) {
    const double size = norm(axis);
    // Sines of the angles between the plane and the vectors, times size.
    const double a0 = dot(a[0], axis) / length[0], a1 = dot(a[1], axis) / length[1],
                 b0 = dot(b[0], axis) / length[2], b1 = dot(b[1], axis) / length[3];
    const double far = kClearAngle * size, none = kDoubleRounding * size;
    const double a_least = std::min(a0, a1), a_most = std::max(a0, a1), b_least = std::min(b0, b1),
                 b_most = std::max(b0, b1);
    return (a_least > -none && b_most < -far) || (a_least > far && b_most < none) ||
           (b_least > -none && a_most < -far) || (b_least > far && a_most < none);
  };
  if (apart_on_both_sides(a, b, length)) return true;
  const Vec3 a_normal = cross(a[0], a[1]), b_normal = cross(b[0], b[1]);
  if (separates(a_normal) || separates(b_normal)) return true;
  for (int i = 0; i < 2; ++i)
    if (separates(cross(a[i], a_normal)) || separates(cross(b[i], b_normal))) return true;
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j)
      if (separates(cross(a[i], b[j]))) return true;
  return false;
}

// Triangles on both sides of the edge from p to q, with third corners c and d: whether their dihedral angle
// is larger than kClearAngle.
bool unfolded(const Vec3& p, const Vec3& q, const Vec3& c, const Vec3& d) {
  const Vec3 along = normalized(q - p);
  const auto inward = [&](const Vec3& corner) {
    const Vec3 r = corner - p;
    return normalized(r - dot(r, along) * along);
  };
  return norm(inward(c) - inward(d)) > kClearAngle;
}

// The product of the unit normals of the faces of an edge is larger unless they are nearly folded together.
constexpr double kUnfolded = -0.99;

bool surely_unfolded(const sites::SitesData& sites, std::uint32_t face, std::uint32_t other) {
  return !sites.sliver[face] && !sites.sliver[other] &&
         dot(sites.normals.face[face], sites.normals.face[other]) > kUnfolded;
}

// Whether `face` has the clearance from `other`, whose box overlaps its enlarged one.
bool clear_of(const sites::SitesData& sites, std::uint32_t face, std::uint32_t other) {
  const Triangle &a = sites.mesh.triangles[face], &b = sites.mesh.triangles[other];
  std::array<int, 3> mine{}, theirs{};  // the shared corners, then the others
  int shared = 0, own = 2;
  bool taken[3] = {};
  for (int i = 0; i < 3; ++i) {
    const int j = a[i] == b[0] ? 0 : a[i] == b[1] ? 1 : a[i] == b[2] ? 2 : 3;
    if (j == 3) {
      mine[own--] = i;
    } else {
      mine[shared] = i;
      theirs[shared++] = j;
      taken[j] = true;
    }
  }
  own = 2;
  for (int j = 0; j < 3; ++j)
    if (!taken[j]) theirs[own--] = j;
  const std::vector<Vec3>& at = sites.mesh.positions;
  switch (shared) {
    case 0:
      return apart(unit_corners(sites, face), unit_corners(sites, other));
    case 1: {
      const Vec3& corner = at[a[mine[0]]];
      return apart_at_corner({at[a[mine[1]]] - corner, at[a[mine[2]]] - corner},
                             {at[b[theirs[1]]] - corner, at[b[theirs[2]]] - corner});
    }
    case 2:
      if (surely_unfolded(sites, face, other)) return true;
      return unfolded(at[a[mine[0]]], at[a[mine[1]]], at[a[mine[2]]], at[b[theirs[2]]]);
    default:
      return false;
  }
}

Box box_of_face(const Mesh& mesh, std::uint32_t face) {
  const Triangle& t = mesh.triangles[face];
  const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
  Box box;
  for (int k = 0; k < 3; ++k) {
    box.lower[k] = std::min(std::min(a[k], b[k]), c[k]);
    box.upper[k] = std::max(std::max(a[k], b[k]), c[k]);
  }
  return box;
}

// The box of a face, enlarged by the clearance.
Box enlarged_box(const sites::SitesData& sites, std::uint32_t face) {
  const double margin = kClearance / sites.frame.scale;
  const Box box = box_of_face(sites.mesh, face);
  return {box.lower - Vec3{margin, margin, margin}, box.upper + Vec3{margin, margin, margin}};
}

bool meet(const tree::FloatBox& a, const tree::FloatBox& b) {
  bool apart = false;
  for (int k = 0; k < 3; ++k) apart = apart || a.upper[k] < b.lower[k] || b.upper[k] < a.lower[k];
  return !apart;
}

// Whether the faces around a vertex of a closed mesh are known to be at angles larger than kClearAngle, but
// for those that share an edge: if they form one turn about its normal n. Seen along n, the faces are sectors
// of at least 4·kClearAngle, one after the other if all have the same orientation and one of them crosses the
// positive half of an axis from below. Between two that share no edge is another one. The planes of faces are
// tilted by at most 60°, so that vectors of length 1 are at least 1/2 long seen along n, and the distance of
// two of them is at least 2·½·sin(½·4·kClearAngle), nearly 2·kClearAngle.
bool has_clear_fan(const sites::SitesData& sites, std::uint32_t vertex) {
  const Vec3 n = normalized(sites.normals.vertex[vertex]);
  const int least = std::abs(n[0]) < std::abs(n[1]) ? (std::abs(n[0]) < std::abs(n[2]) ? 0 : 2)
                                                    : (std::abs(n[1]) < std::abs(n[2]) ? 1 : 2);
  Vec3 across;
  across[least] = 1;
  const Vec3 axis = cross(n, across);
  constexpr double kSector = 4 * kClearAngle, kOnAxis = 1e-9;
  const std::vector<Vec3>& at = sites.mesh.positions;
  int turns = 0;
  for (const std::uint32_t face : sites.vertex_faces.of(vertex)) {
    const Triangle& t = sites.mesh.triangles[face];
    const int k = t[0] == vertex ? 0 : t[1] == vertex ? 1 : 2;
    const bool reverse = sites.inverted[face] != 0;
    const Vec3 a = at[t[(k + (reverse ? 2 : 1)) % 3]] - at[vertex],
               b = at[t[(k + (reverse ? 1 : 2)) % 3]] - at[vertex], normal = cross(a, b);
    const double area = dot(normal, n), sides = squared_norm(a) * squared_norm(b);
    if (!(area > 0) || !(area * area > 0.25 * squared_norm(normal)) ||
        !(area * area > kSector * kSector * sides))
      return false;
    const double from = dot(a, axis), to = dot(b, axis);
    if (!(from * from > kOnAxis * kOnAxis * squared_norm(a))) return false;
    turns += from < 0 && to > 0 ? 1 : 0;
  }
  return turns == 1;
}

/// The pairs of near faces of which one is in a leaf, and the other one in it or in a later leaf.
class NearPairs {
 public:
  /// Uses the memory of `pairs`.
  NearPairs(const sites::SitesData& sites, const FaceBoxes& boxes, std::span<const std::uint8_t> clear_fans,
            std::vector<std::uint8_t>& flags, std::vector<FacePair>& pairs)
      : sites_(sites), boxes_(boxes), clear_fans_(clear_fans), flags_(flags), pairs_(pairs) {}

  void flag(std::uint32_t leaf) {
    pairs_.clear();
    append_overlapping(sites_, boxes_, leaf, leaf, pairs_);
    // More than the clearance, and than its rounding.
    constexpr float kMargin = 1.25F * static_cast<float>(kClearance);
    tree::FloatBox enlarged = sites_.tree.box(leaf);
    for (int k = 0; k < 3; ++k) {
      enlarged.lower[k] -= kMargin;
      enlarged.upper[k] += kMargin;
    }
    // Nodes with earlier leaves only have been compared.
    const auto enter = [&](tree::Subtree below) {
      return below.end > leaf + 1 && meet(sites_.tree.box(below.root), enlarged);
    };
    const auto visit_leaf = [&](std::uint32_t other) {
      if (other > leaf) append_overlapping(sites_, boxes_, leaf, other, pairs_);
    };
    visit(sites_.tree, tree::InOrder{enter, visit_leaf});
    for (const FacePair& pair : pairs_) compare(pair);
  }
  /// Compares the pairs that wait for a full set of lanes.
  void finish() {
    const std::uint32_t apart = triangles_.apart(kClearance);
    for (std::size_t i = 0; i < triangles_.size(); ++i)
      if ((apart >> i & 1u) == 0 && !clear_of(sites_, waiting_[i][0], waiting_[i][1])) flag(waiting_[i]);
    triangles_.clear();
  }

 private:
  void compare(const FacePair& pair) {
    const Triangle &a = sites_.mesh.triangles[pair[0]], &b = sites_.mesh.triangles[pair[1]];
    std::uint32_t corner = kNone;
    int shared = 0;
    for (const std::uint32_t v : a)
      if (v == b[0] || v == b[1] || v == b[2]) {
        corner = v;
        ++shared;
      }
    if (shared == 0) {
      waiting_[triangles_.size()] = pair;
      triangles_.add(unit_corners(sites_, pair[0]), unit_corners(sites_, pair[1]));
      if (triangles_.full()) finish();
    } else if (!(shared == 1 && clear_fans_[corner] != 0) &&
               !(shared == 2 && surely_unfolded(sites_, pair[0], pair[1])) &&
               !clear_of(sites_, pair[0], pair[1])) {
      flag(pair);
    }
  }
  void flag(const FacePair& pair) {
    for (const std::uint32_t near : pair) std::atomic_ref(flags_[near]).store(1, std::memory_order_relaxed);
  }

  const sites::SitesData& sites_;
  const FaceBoxes& boxes_;
  std::span<const std::uint8_t> clear_fans_;  ///< of each vertex: has_clear_fan()
  std::vector<std::uint8_t>& flags_;
  std::vector<FacePair>& pairs_;
  TrianglePairs triangles_;
  std::array<FacePair, TrianglePairs::kMost> waiting_{};
};

}  // namespace

Corners unit_corners(const sites::SitesData& sites, std::uint32_t face) {
  const auto& [a, b, c] = sites.mesh.triangles[face];
  const std::vector<Vec3>& p = sites.mesh.positions;
  return {sites.frame.to_unit(p[a]), sites.frame.to_unit(p[b]), sites.frame.to_unit(p[c])};
}

// The axes are those of the separating axis theorem for triangles in space and in one plane.
bool apart(const Corners& a, const Corners& b) {
  const auto separates = [&](const Vec3& axis) {
    const auto [a_least, a_most] = extent(a, axis);
    const auto [b_least, b_most] = extent(b, axis);
    const double gap = std::max(a_least - b_most, b_least - a_most);
    return gap > 0 && gap * gap > kClearance * kClearance * squared_norm(axis);
  };
  for (int k = 0; k < 3; ++k)  // mostly enough for parts of faces
    if (std::min({a[0][k], a[1][k], a[2][k]}) - std::max({b[0][k], b[1][k], b[2][k]}) > kClearance ||
        std::min({b[0][k], b[1][k], b[2][k]}) - std::max({a[0][k], a[1][k], a[2][k]}) > kClearance)
      return true;
  std::array<Vec3, 3> a_edge, b_edge;
  for (int i = 0; i < 3; ++i) {
    a_edge[i] = a[(i + 1) % 3] - a[i];
    b_edge[i] = b[(i + 1) % 3] - b[i];
  }
  const Vec3 a_normal = cross(a_edge[0], a_edge[1]), b_normal = cross(b_edge[0], b_edge[1]);
  if (separates(a_normal) || separates(b_normal)) return true;
  for (int i = 0; i < 3; ++i)
    if (separates(cross(a_edge[i], a_normal)) || separates(cross(b_edge[i], b_normal))) return true;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (separates(cross(a_edge[i], b_edge[j]))) return true;
  return false;
}

void find_near_faces(const sites::SitesData& sites, std::uint32_t face, std::vector<std::uint32_t>& near) {
  near.clear();
  const Box enlarged = enlarged_box(sites, face);
  const auto unit =
      tree::FloatBox::around({sites.frame.to_unit(enlarged.lower), sites.frame.to_unit(enlarged.upper)});
  const auto enter = [&](tree::Subtree below) { return meet(sites.tree.box(below.root), unit); };
  const auto visit_leaf = [&](std::uint32_t leaf) {
    for (const std::uint32_t other : sites.tree.items_of(leaf))
      if (other != face && overlap(enlarged, box_of_face(sites.mesh, other)) && !clear_of(sites, face, other))
        near.push_back(other);
  };
  visit(sites.tree, tree::InOrder{enter, visit_leaf});
}

void flag_faces_with_near(const sites::SitesData& sites, std::vector<std::uint8_t>& flags) {
  flags.assign(sites.mesh.triangles.size(), 0);
  thread_local std::vector<std::uint32_t> kept;  // its memory
  std::vector<std::uint32_t>& leaves = kept;
  leaves.clear();
  visit(sites.tree, tree::InOrder{[](tree::Subtree) { return true; },
                                  [&](std::uint32_t leaf) { leaves.push_back(leaf); }});
  thread_local std::vector<std::uint8_t> kept_fans;
  std::vector<std::uint8_t>& clear_fans = kept_fans;
  clear_fans.assign(sites.mesh.positions.size(), 0);
  parallel_for(clear_fans.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      clear_fans[v] = has_clear_fan(sites, static_cast<std::uint32_t>(v));
  });
  thread_local FaceBoxes kept_boxes;
  FaceBoxes& boxes = kept_boxes;
  boxes.set(sites, 0.625 * kClearance);  // together more than it, by more than rounding
  parallel_for(leaves.size(), 256, [&](std::size_t begin, std::size_t end) {
    thread_local std::vector<FacePair> of_leaf;
    NearPairs pairs(sites, boxes, clear_fans, flags, of_leaf);
    for (std::size_t i = begin; i < end; ++i) pairs.flag(leaves[i]);
    pairs.finish();
  });
}

}  // namespace sdm::inside
