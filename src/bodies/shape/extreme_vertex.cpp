#include "bodies/shape/extreme_vertex.h"

#include <vector>

#include "tree/visit.h"

namespace sdm::shape {
namespace {

constexpr int kWidth = tree::WideTree::kWidth;

// Finds the vertex; the policy of its search of the tree.
class Search {
 public:
  Search(const sites::SitesData& sites, const Vec3& u, const ExtremeVertex& known)
      : sites_(sites), u_(u), best_(known) {
    for (int k = 0; k < 3; ++k) unit_u_[k] = static_cast<float>(u[k]);
    limit();
  }

  ExtremeVertex find() {
    thread_local std::vector<tree::OpenNode> stack;
    tree::visit(sites_.wide, stack, *this);
    return best_;
  }

  // The farthest first; of equal ones, that in the first slot.
  static bool before(float first, float second) { return first >= second; }
  [[nodiscard]] bool enter(const tree::OpenNode& open) const {
    return open.child == 0 || open.bound >= limit_;
  }
  std::uint32_t bound(const tree::OpenNode&, const tree::WideTree::Node& node, float (&most)[kWidth]) const {
    for (float& x : most) x = 0;
    for (int k = 0; k < 3; ++k) {
      const float* far = unit_u_[k] > 0 ? node.upper[k] : node.lower[k];
      for (int i = 0; i < kWidth; ++i) most[i] += unit_u_[k] * far[i];
    }
    return (1u << node.count) - 1;
  }
  void leaf(const tree::OpenNode& open) {
    const std::uint32_t leaf = open.leaf_number();
    for (std::uint32_t i = sites_.regions.leaves[leaf]; i < sites_.regions.leaves[leaf + 1]; ++i)
      for (const std::uint32_t vertex : sites_.mesh.triangles[sites_.regions.owners[i].face]) {
        const Vec3& x = sites_.mesh.positions[vertex];
        if (const double along = dot(u_, x); along > best_.along) best_ = {along, x};
      }
    limit();
  }

 private:
  void limit() {
    constexpr float kAlongRounding = 4e-6F;  // in the unit frame
    limit_ = static_cast<float>(sites_.frame.scale * (best_.along - dot(u_, sites_.frame.origin))) -
             kAlongRounding;
  }

  const sites::SitesData& sites_;
  const Vec3 u_;
  float unit_u_[3];
  float limit_ = 0;  // nodes below this are no farther than the best
  ExtremeVertex best_;
};

}  // namespace

ExtremeVertex extreme_vertex(const sites::SitesData& sites, const Vec3& u, const ExtremeVertex& known) {
  return Search(sites, u, known).find();
}

}  // namespace sdm::shape
