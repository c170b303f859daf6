#include "certify/prove_tolerance.h"

#include <sdm/error.h>
#include <sdm/map.h>
#include <sdm/mesh.h>
#include <sdm/tolerance.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <string>
#include <vector>

#include "certify/hausdorff/largest_distance.h"
#include "certify/hausdorff/matching.h"
#include "certify/hausdorff/nearest_face.h"
#include "certify/hausdorff/side.h"
#include "certify/hausdorff/vertex_search.h"
#include "closest/exact.h"
#include "closest/facing/facing_normals.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/rounding.h"
#include "geometry/triangle_pair.h"
#include "geometry/vec.h"
#include "inside/inside.h"
#include "inside/solid.h"
#include "mesh/validate.h"
#include "sites/sites_data.h"
#include "tree/visit.h"

namespace sdm::tolerance {
namespace {

/// The least distance of the faces of A from B.
struct LeastDistance {
  double value = 0;                                  ///< to rounding
  Vec3 point{}, closest{};                           ///< of A and of B
  std::uint32_t face = kNone, closest_face = kNone;  ///< kNone: no face is closer than `most`
};

// Lowers `least` by the distance of a face of A.
void lower_by_face(const sites::SitesData& b, const Corners& corners, std::uint32_t face,
                   const hausdorff::Matching* matching, LeastDistance& least) {
  Box box;
  double size = 1;
  for (const Vec3& corner : corners) {
    const Vec3 unit = b.frame.to_unit(corner);
    extend(box, unit);
    for (const double x : unit) size = std::max(size, std::abs(x));
  }
  const tree::FloatBox around = tree::FloatBox::around(box);
  const auto bound = [&](std::uint32_t node, const tree::FloatBox& other) {
    if (matching != nullptr && !matching->may_allow(face, node)) return kInfinity;
    return (1 - 1e-12) * norm(tree::gap(around, other)) - kFewRoundings * size;
  };
  const auto enter = [&](double distance) { return distance < least.value * b.frame.scale; };
  const auto leaf = [&](std::uint32_t node) {
    for (const std::uint32_t other : b.tree.items_of(node)) {
      if (matching != nullptr && !matching->allows(face, other)) continue;
      const Corners near = corners_of(b.mesh, other);
      if (!(squared_box_distance(corners, near) < least.value * least.value)) continue;
      const PointPair pair = closest_or_common(corners, near);
      if (const double distance = std::sqrt(pair.squared); distance < least.value)
        least = {distance, pair.point1, pair.point2, face, other};
    }
  };
  tree::visit(b.tree, tree::NearestFirst{bound, enter, leaf});
}

/// Returns the least distance of the faces of A from B, or from those that `matching` allows for each, if it
/// is below `most`, otherwise `most`. Cost: for each face of A a search of the faces of B that are closer;
/// all cores.
LeastDistance least_distance(const Mesh& a, const sites::SitesData& b, double most,
                             const hausdorff::Matching* matching = nullptr) {
  constexpr std::size_t kBlock = 256;
  const std::size_t blocks = (a.triangles.size() + kBlock - 1) / kBlock;
  std::vector<LeastDistance> found(blocks);
  parallel_for(blocks, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      found[i].value = most;
      for (std::size_t f = kBlock * i; f < std::min(kBlock * (i + 1), a.triangles.size()); ++f)
        if (!hausdorff::repeats_corner(a.triangles[f]))
          lower_by_face(b, corners_of(a, f), static_cast<std::uint32_t>(f), matching, found[i]);
    }
  });
  LeastDistance least{.value = most};
  for (const LeastDistance& block : found)
    if (block.value < least.value) least = block;
  return least;
}

}  // namespace
}  // namespace sdm::tolerance

namespace sdm {
namespace {

using hausdorff::LowerBound;
using hausdorff::NearestFace;
using hausdorff::SheetSide;
using hausdorff::SolidSide;

/// The faces of a mesh that matter, with their vertices in the order that they have. Cost: by these faces,
/// and not by the mesh, of which there may be many parts.
Mesh part_of(const Mesh& mesh, std::span<const std::uint32_t> faces) {
  Mesh part;
  part.triangles.reserve(faces.size());
  std::vector<std::uint32_t> vertices;
  for (const std::uint32_t face : faces) {
    if (face >= mesh.triangles.size())
      throw Error("the surface has no face " + std::to_string(face) + " for a tolerance to be proven of");
    part.triangles.push_back(mesh.triangles[face]);
    vertices.insert(vertices.end(), part.triangles.back().begin(), part.triangles.back().end());
  }
  std::ranges::sort(vertices);
  vertices.erase(std::ranges::unique(vertices).begin(), vertices.end());
  for (const std::uint32_t vertex : vertices) part.positions.push_back(mesh.positions[vertex]);
  for (Triangle& triangle : part.triangles)
    for (std::uint32_t& vertex : triangle)
      vertex = static_cast<std::uint32_t>(std::ranges::lower_bound(vertices, vertex) - vertices.begin());
  return part;
}

/// The three-valued AND: `outside` if either is, `inside` if both are, otherwise undecided, by the larger
/// amount.
ToleranceProof operator&(const ToleranceProof& a, const ToleranceProof& b) {
  if (a.proof == Proof::fails || b.proof == Proof::holds) return a;
  if (b.proof == Proof::fails || a.proof == Proof::holds) return b;
  ToleranceProof worse = a.undecided_by < b.undecided_by ? b : a;
  worse.depends_on_signs = a.depends_on_signs || b.depends_on_signs;
  worse.faces_without_match = std::max(a.faces_without_match, b.faces_without_match);
  return worse;
}

/// Proves or refutes tolerances of a surface against O2.
class Prover {
 public:
  /// `matching`: of the faces of `a`, null without options.facing. `box`: of O2.
  Prover(const Mesh& a, const sites::SitesData& b, SignMethod sign, const ToleranceProofOptions& options,
         const hausdorff::Matching* matching, const Box& box)
      : a_(a),
        b_(b),
        sign_(sign),
        options_(options),
        matching_(matching),
        scale_(hausdorff::scale_of(a, box)) {}

  ToleranceProof operator()(const Tolerance& tolerance) const {
    const double lo = std::max(tolerance.lower, -kFarthest), hi = std::min(tolerance.upper, kFarthest);
    const double least = std::max({lo, -hi, 0.0}), most = std::max(-lo, hi), tight = std::min(-lo, hi);
    if (sign_ == SignMethod::none) return at_least(least, true) & at_most(hi);
    const bool has_estimate = matching_ != nullptr || is_estimate(sign_);  // of the sign
    if (has_estimate && lo != -hi) return by_either_sign(lo, hi);
    if (tight < 0) {
      const ToleranceProof apart = at_least(least, lo > 0);
      return apart.proof == Proof::holds ? on_side(hi < 0) & at_most(most) : apart;
    }
    return tight == most ? at_most(most) : at_most(tight, -lo < hi) & at_most(most);
  }

 private:
  // Stands for an infinite limit: no distance is larger.
  static constexpr double kFarthest = std::numeric_limits<double>::max() / 4;

  /// Whether no distance is larger, of the points on one side of O2 or of all.
  ToleranceProof at_most(double limit, std::optional<bool> inside = {}) const {
    if (limit == kFarthest && matching_ == nullptr) return {.proof = Proof::holds};
    std::optional<SolidSide> side;
    if (inside) side.emplace(b_, *inside);
    const hausdorff::Decision decision{.limit = limit, .forgiven = limit + options_.accuracy};
    const hausdorff::LargestDistance found = hausdorff::largest_distance(a_, b_, scale_,
                                                                         {.decision = decision,
                                                                          .side = side ? &*side : nullptr,
                                                                          .matching = matching_,
                                                                          .most_parts = options_.most_parts},
                                                                         options_.progress);
    ToleranceProof result{.at_lower = inside.value_or(false), .faces_without_match = found.unmatched.size()};
    if (found.lower.faces[0] != kNone) {
      result.witness = witness(found.lower);
      result.at_lower = result.witness->distance < 0;
    }
    if (result.witness && norm(found.lower.closest - found.lower.point) > decision.forgiven) {
      result.proof = Proof::fails;
    } else if (!found.unmatched.empty()) {
      result.proof = Proof::fails;
      result.witness.reset();
    } else if (!result.witness && found.upper <= limit + scale_.precision) {
      result.proof = Proof::holds;
    } else {
      result.undecided_by = std::max(found.upper - limit, 0.0);
    }
    return result;
  }

  /// Whether no |distance| is smaller; `at_lower`: that is the lower limit.
  ToleranceProof at_least(double limit, bool at_lower) const {
    if (!(limit > 0)) return {.proof = Proof::holds};
    const tolerance::LeastDistance found = tolerance::least_distance(a_, b_, limit, matching_);
    ToleranceProof result{.at_lower = at_lower};
    if (found.face == kNone || found.value >= limit - scale_.precision) {
      result.proof = Proof::holds;
      return result;
    }
    result.witness = {found.point, found.closest, found.face, found.closest_face, found.value};
    if (limit - found.value > options_.accuracy)
      result.proof = Proof::fails;
    else
      result.undecided_by = limit - found.value;
    return result;
  }

  /// Whether all faces of a surface that does not meet O2 are on a side of it: by one corner each.
  ToleranceProof on_side(bool inside) const {
    const SolidSide side(b_, inside);
    std::vector<std::uint8_t> wrong(a_.triangles.size());
    parallel_for(wrong.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) {
        const Triangle& t = a_.triangles[f];
        if (!hausdorff::repeats_corner(t)) wrong[f] = side.has(a_.positions[t[0]]) ? 0 : 1;
      }
    });
    const auto found = std::ranges::find(wrong, 1);
    if (found == wrong.end()) return {.proof = Proof::holds};
    const auto face = static_cast<std::uint32_t>(found - wrong.begin());
    const Vec3& p = a_.positions[a_.triangles[face][0]];
    LowerBound at;
    at.raise(p, 0, face, hausdorff::nearest_face(b_, p, b_.tree.items[0]));
    return {.proof = Proof::fails, .witness = witness(at), .at_lower = !inside};
  }

  /// Proves by |d| alone: within the tolerance with either sign, or with neither. With SignMethod::side, also
  /// by whether the points that are within it with one sign only are on that side of O2.
  ToleranceProof by_either_sign(double lo, double hi) const {
    const double tight = std::min(-lo, hi);
    if (tight >= 0) {
      const ToleranceProof within = at_most(tight);
      if (within.proof == Proof::holds) return within;
    }
    ToleranceProof result = at_most(std::max(-lo, hi));
    if (result.proof == Proof::fails) return result;
    if (result.proof == Proof::holds && sign_ == SignMethod::side && matching_ == nullptr &&
        (tight >= 0 || at_least(-tight, lo > 0).proof == Proof::holds) &&
        none_beyond(std::max(tight, 0.0), -lo < hi))
      return result;
    result.proof = Proof::undecided;
    result.undecided_by.reset();
    result.depends_on_signs = true;
    return result;
  }

  /// Whether all points with a larger distance are certain not to be on this side of an open O2.
  bool none_beyond(double limit, bool behind) const {
    // Next to the curve where the side changes, no number of parts is enough.
    constexpr std::size_t kLeastParts = std::size_t{1} << 16, kPartsOfFace = 8;
    const std::size_t most_parts = std::max(kLeastParts, kPartsOfFace * a_.triangles.size());
    const SheetSide side(b_, behind, scale_.precision);
    const hausdorff::LargestDistance found =
        hausdorff::largest_distance(a_, b_, scale_,
                                    {.decision = hausdorff::Decision{.limit = limit, .forgiven = limit},
                                     .side = &side,
                                     .most_parts = std::min(options_.most_parts, most_parts)},
                                    options_.progress);
    return found.lower.faces[0] == kNone && found.upper <= limit + scale_.precision;
  }

  ToleranceWitness witness(const LowerBound& at) const {
    const double distance = norm(at.closest - at.point);
    if (matching_ != nullptr) {
      const bool behind = sign_ != SignMethod::none && matching_->behind(at.faces[0], at.point);
      return {at.point, at.closest, at.faces[0], at.faces[1], behind ? -distance : distance};
    }
    constexpr double kAnywhere = kInfinity;
    const auto estimate = [&] {
      return inside::InsideTest(b_, sign_)(at.point, closest::exact_closest(b_, at.point, kAnywhere));
    };
    const bool is_inside = sign_ == SignMethod::exact ? distance > 0 && inside::contains(b_, at.point)
                                                      : is_estimate(sign_) && estimate();
    return {at.point, at.closest, at.faces[0], at.faces[1], is_inside ? -distance : distance};
  }

  const Mesh& a_;
  const sites::SitesData& b_;
  SignMethod sign_;
  const ToleranceProofOptions& options_;
  const hausdorff::Matching* matching_;
  hausdorff::Scale scale_;
};

void check_question(const Tolerance& tolerance, const ToleranceProofOptions& options) {
  const bool has_limit = std::isfinite(tolerance.lower) || std::isfinite(tolerance.upper);
  if (!(tolerance.lower <= tolerance.upper && has_limit && tolerance.upper > -kInfinity &&
        tolerance.lower < kInfinity))
    throw Error("the tolerance to prove must be two numbers, the smaller one first, of which one is finite");
  if (!(options.accuracy >= 0)) throw Error("the accuracy of a tolerance's proof must be at least 0");
}

}  // namespace

hausdorff::Matching tolerance::matching_of(const Mesh& surface, const Sites& sites, double angle) {
  return {internals(sites), angle, facing::facing_normals(surface, angle).normals};
}

ToleranceProof tolerance::prove_valid(const Mesh& surface, const Sites& sites, const Tolerance& tolerance,
                                      const ToleranceProofOptions& options, const Known& known) try {
  check_question(tolerance, options);
  const SignUsed sign = choose_sign(sites, MapOptions{.sign = options.sign, .facing = options.facing});
  if (sign.method == SignMethod::none && tolerance.needs_sign())
    throw Error("a tolerance that differs by sign needs signed distances, but these are unsigned: " +
                    sign.reason + "; choose another sign method or a symmetric tolerance",
                Remedy::sign_method);
  std::optional<hausdorff::Matching> matching;
  if (options.facing)
    matching.emplace(known.matching ? *known.matching : matching_of(surface, sites, *options.facing));
  const auto prove = [&](const Mesh& mesh) {
    return Prover(mesh, internals(sites), sign.method, options, matching ? &*matching : nullptr,
                  known.box)(tolerance);
  };
  if (!options.faces) return prove(surface);
  const Mesh part = part_of(surface, *options.faces);
  if (matching) matching.emplace(matching->of_part(*options.faces));
  ToleranceProof result = prove(part);
  if (result.witness) result.witness->face = (*options.faces)[result.witness->face];
  return result;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the proof of a tolerance");
}

ToleranceProof prove_tolerance(const Mesh& surface, const Sites& sites, const Tolerance& tolerance,
                               const ToleranceProofOptions& options) {
  check_question(tolerance, options);
  if (std::ranges::any_of(surface.triangles, is_removed))
    mesh::validate_edited(surface);
  else
    validate(surface);
  return tolerance::prove_valid(surface, sites, tolerance, options, {bounds(sites.mesh())});
}

}  // namespace sdm
