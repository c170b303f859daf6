#include "query/shape/extreme_vertex.h"

#include "geometry/vec.h"

namespace sdm::shape {
namespace {

constexpr int kWidth = tree::WideTree::kWidth;

class Search {
 public:
  Search(const sites::SitesData& sites, const Vec3& u, const ExtremeVertex& known)
      : sites_(sites), u_(u), best_(known) {
    for (int k = 0; k < 3; ++k) unit_u_[k] = static_cast<float>(u[k]);
    limit();
  }

  ExtremeVertex find() {
    open(0);
    return best_;
  }

 private:
  // The child with the largest bound first.
  void open(std::uint32_t index) {
    const tree::WideTree::Node& node = sites_.wide.nodes[index];
    float most[kWidth] = {};
    for (int k = 0; k < 3; ++k) {
      const float* far = unit_u_[k] > 0 ? node.hi[k] : node.lo[k];
      for (int i = 0; i < kWidth; ++i) most[i] += unit_u_[k] * far[i];
    }
    for (std::uint32_t left = (1u << node.count) - 1; left != 0;) {
      std::uint32_t largest = kWidth;
      for (std::uint32_t i = 0; i < node.count; ++i)
        if ((left >> i & 1) != 0 && (largest == kWidth || most[i] > most[largest])) largest = i;
      if (!(most[largest] >= limit_)) return;
      left &= ~(1u << largest);
      if (tree::WideTree::is_leaf(node.child[largest]))
        compare(tree::WideTree::leaf_number(node.child[largest]));
      else
        open(node.child[largest]);
    }
  }

  void compare(std::uint32_t leaf) {
    for (std::uint32_t i = sites_.regions.leaves[leaf]; i < sites_.regions.leaves[leaf + 1]; ++i)
      for (const std::uint32_t vertex : sites_.mesh.triangles[sites_.regions.owners[i].face]) {
        const Vec3& x = sites_.mesh.positions[vertex];
        if (const double along = dot(u_, x); along > best_.along) best_ = {along, x};
      }
    limit();
  }

  void limit() {
    constexpr float kRounding = 4e-6F;  // of the bounds, in the unit frame
    limit_ =
        static_cast<float>(sites_.frame.scale * (best_.along - dot(u_, sites_.frame.origin))) - kRounding;
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
