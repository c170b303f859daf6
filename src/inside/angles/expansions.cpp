#include "inside/angles/expansions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "core/cancellation.h"
#include "geometry/rounding.h"

namespace sdm::inside {
namespace {

// Sums over faces in double precision.
struct Moments {
  Vec3 centre{};                  ///< area-weighted mean
  Vec3 moment{};                  ///< M
  std::array<double, 6> first{};  ///< the symmetric part of T
  double area = 0;
  double second = 0;  ///< ∫|x − c|² dA
  double radius = 0;  ///< R
  double edges = 0;   ///< P

  /// Adds what others have about their centre, about the centre of this.
  void add(const Moments& part) {
    const Vec3 d = part.centre - centre;
    const Vec3& m = part.moment;
    const std::array<double, 6> moved{d[0] * m[0],
                                      d[1] * m[1],
                                      d[2] * m[2],
                                      0.5 * (d[0] * m[1] + d[1] * m[0]),
                                      0.5 * (d[1] * m[2] + d[2] * m[1]),
                                      0.5 * (d[2] * m[0] + d[0] * m[2])};
    for (std::size_t i = 0; i < moved.size(); ++i) first[i] += part.first[i] + moved[i];
    moment += m;
    area += part.area;
    edges += part.edges;
    second += part.second + part.area * squared_norm(d);
  }
};

// A float that is at least the value, and larger than any number that underflows.
float rounded_up(double value) {
  constexpr float kLeast = 1e-30F;
  return std::nextafter(static_cast<float>(value), std::numeric_limits<float>::infinity()) + kLeast;
}

class ExpansionsOfTree {
 public:
  ExpansionsOfTree(const OrientedFaces& faces, const tree::WideTree& wide) : faces_(faces), wide_(wide) {}

  // Children follow their parents.
  TreeExpansions build() {
    TreeExpansions result;
    result.nodes.resize(wide_.nodes.size());
    std::vector<Expansions>& blocks = result.nodes;
    result.faces.resize(faces_.faces.tree.items.size());
    std::vector<Moments> of_node(wide_.nodes.size());
    Poll due(256);
    for (std::size_t n = wide_.nodes.size(); n-- > 0;) {
      due();
      const tree::WideTree::Node& node = wide_.nodes[n];
      parts_.clear();
      for (std::uint32_t i = 0; i < node.count; ++i) {
        const bool leaf = tree::WideTree::is_leaf(node.child[i]);
        Moments child = leaf ? of_leaf(node.source[i], result.faces) : of_node[node.child[i]];
        child.radius =
            std::min(child.radius, radius_by_box(child.centre, faces_.faces.tree.box(node.source[i])));
        store(child, blocks[n], i);
        parts_.push_back(child);
      }
      of_node[n] = sum(parts_);
      for (const Moments& part : parts_)
        of_node[n].radius = std::max(of_node[n].radius, norm(part.centre - of_node[n].centre) + part.radius);
    }
    return result;
  }

 private:
  [[nodiscard]] Moments of_face(std::uint32_t face) const {
    const auto [a, b, c] = faces_.corners(face);
    const UnitFrame& frame = faces_.faces.frame;
    const Vec3 ab = frame.scale * (b - a), ac = frame.scale * (c - a), bc = frame.scale * (c - b);
    Moments face_moments;
    face_moments.centre = (1.0 / 3) * (frame.to_unit(a) + frame.to_unit(b) + frame.to_unit(c));
    face_moments.moment = 0.5 * cross(ab, ac);
    face_moments.area = norm(face_moments.moment);
    face_moments.second = face_moments.area / 36 * (squared_norm(ab) + squared_norm(bc) + squared_norm(ac));
    face_moments.edges = norm(ab) * norm(ac);
    // The vector from the centroid to a corner is a third of the sum of the sides there.
    face_moments.radius =
        (1.0 / 3) *
        std::sqrt(std::max({squared_norm(ab + ac), squared_norm(bc - ab), squared_norm(ac + bc)}));
    return face_moments;
  }
  [[nodiscard]] Moments of_leaf(std::uint32_t leaf, FaceExpansions& of_each) {
    const FaceTree& faces = faces_.faces;
    of_faces_.clear();
    std::size_t place = faces.tree.nodes[leaf].first;
    for (const std::uint32_t face : faces.tree.items_of(leaf)) {
      of_faces_.push_back(of_face(face));
      store(of_faces_.back(), of_each, place++);
    }
    Moments total = sum(of_faces_);
    double squared = 0;
    for (const std::uint32_t face : faces.tree.items_of(leaf))
      for (const std::uint32_t v : faces.triangles[face])
        squared = std::max(squared, squared_norm(faces.frame.to_unit(faces.positions[v]) - total.centre));
    total.radius = std::sqrt(squared);
    return total;
  }
  // Faces without area do not pull the centre.
  [[nodiscard]] static Moments sum(std::span<const Moments> parts) {
    Moments total;
    double area = 0;
    for (const Moments& part : parts) area += part.area;
    for (const Moments& part : parts)
      total.centre += (area > 0 ? part.area / area : 1.0 / static_cast<double>(parts.size())) * part.centre;
    for (const Moments& part : parts) total.add(part);
    return total;
  }
  // The distance to the farthest corner of the box.
  [[nodiscard]] static double radius_by_box(const Vec3& centre, const tree::FloatBox& box) {
    Vec3 farthest;
    for (int k = 0; k < 3; ++k)
      farthest[k] = std::max(std::abs(box.lower[k] - centre[k]), std::abs(box.upper[k] - centre[k]));
    return norm(farthest);
  }
  // About a centre in single precision.
  static void store(const Moments& child, Expansions& block, std::uint32_t lane) {
    constexpr double u = 0x1p-24, w = 0x1p-53;
    Moments about;
    for (int k = 0; k < 3; ++k) about.centre[k] = static_cast<float>(child.centre[k]);
    about.add(child);
    for (int k = 0; k < 3; ++k) block.centre[k][lane] = static_cast<float>(child.centre[k]);
    for (int k = 0; k < 3; ++k) block.moment[k][lane] = static_cast<float>(about.moment[k]);
    for (std::size_t k = 0; k < about.first.size(); ++k)
      block.first[k][lane] = static_cast<float>(about.first[k]);
    const double radius = norm(child.centre - about.centre) + child.radius;
    block.area[lane] = rounded_up(about.area);
    block.second[lane] = rounded_up(about.second);
    block.radius[lane] = rounded_up((1 + kProductRounding) * radius + Expansions::kDisplacement);
    block.noise[lane] = rounded_up(256 * (u * about.area + w * about.edges));
  }

  static void store(const Moments& face, FaceExpansions& of_each, std::size_t place) {
    constexpr double u = 0x1p-24, w = 0x1p-53, moved = FaceExpansions::kCentreRounding;
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      of_each.centre[axis][place] = static_cast<float>(face.centre[k]);
      of_each.moment[axis][place] = static_cast<float>(face.moment[k]);
    }
    of_each.second[place] = rounded_up(face.second + face.area * moved * moved);
    of_each.radius[place] = rounded_up((1 + kProductRounding) * face.radius + moved);
    of_each.noise[place] = rounded_up(256 * (u * face.area + w * face.edges));
  }

  OrientedFaces faces_;
  const tree::WideTree& wide_;
  std::vector<Moments> parts_, of_faces_;
};

}  // namespace

void FaceExpansions::resize(std::size_t faces) {
  const std::size_t size = faces + Expansions::kWidth;
  for (auto* three : {&centre, &moment})
    for (std::vector<float>& of_axis : *three) of_axis.assign(size, 0);
  for (auto* of_faces : {&second, &radius, &noise}) of_faces->assign(size, 0);
}

TreeExpansions expansions_of(const OrientedFaces& faces, const tree::WideTree& wide) {
  return ExpansionsOfTree(faces, wide).build();
}

}  // namespace sdm::inside
