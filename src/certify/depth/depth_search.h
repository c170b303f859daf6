// The penetration depth of two bodies, from their triangles.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "bodies/shape/posed_body.h"
#include "certify/depth/leaving.h"

namespace sdm::depth {

/// Bounds on a depth, in space.
struct Depth {
  double lower = 0, upper = 0;
  double value = 0;  ///< that of `points`, if any: a point of O1 and one of O2
  std::optional<std::array<Vec3, 2>> points{};
};

/// Finds the largest distance from a point of either surface inside the other body to the boundary of that
/// body, by branch and bound. Parts of a surface are at first the nodes of its tree, then its triangles and
/// their quarters.
class DepthSearch : public search::Policy {
 public:
  using Bodies = std::array<const shape::PosedBody*, 2>;

  /// Divides parts until the bounds are at most `precision` apart, in space, as far as those on the distance
  /// to the boundary of a solid that intersects itself are, and at most 2¹⁸ parts are measured. Distances are
  /// computed to about 1e-6 of the size of both bodies, which is not part of the bounds. Cost: some thirty
  /// searches for the closest point, more where surfaces are nearly parallel; all cores if there are many.
  /// Reuses its memory.
  [[nodiscard]] Depth find(const Bodies& bodies, const std::array<mesh::Similarity, 2>& to_other,
                           double precision);

  // The fraction of many open parts that is evaluated together: neighbours are among them, and share
  // searches.
  static constexpr std::size_t kFraction = 64, kRun = 256;
  bool tighten(SurfacePart& part) { return leaving_[part.body].tighten(part, parts_.enough()); }
  bool expand(const SurfacePart& part);
  static void arrange(std::span<SurfacePart> batch);
  void evaluate(std::span<SurfacePart> run, std::vector<Value>& values) const;
  void learn(std::span<const SurfacePart> run, const std::vector<Value>& values);
  void conclude(std::span<SurfacePart> run, const std::vector<Value>& values);

  [[nodiscard]] bool within_budget() const { return measured_ <= budget_; }

 private:
  void search_all();
  [[nodiscard]] bool walls_are_no_deeper() const;
  [[nodiscard]] bool look_at_walls();
  void find_exits(int body);
  [[nodiscard]] bool improve(int body, const Vec3& p, const BoundaryDistance& b);
  void evaluate_one(SurfacePart& part, Value& value) const;

  Bodies bodies_{};
  std::array<Leaving, 2> leaving_;  // by the body that leaves the other
  double precision_ = 0, coarse_ = 0;
  std::size_t measured_ = 0, budget_ = 0;  // parts
  Depth depth_;
  Parts parts_;
};

}  // namespace sdm::depth
