// The closest faces of two surfaces, by their two trees: no triangle is moved but those that are compared.
#pragma once

#include <algorithm>
#include <functional>
#include <vector>

#include "proximity/exact/mesh_pair.h"

namespace sdm::exact {

/// Per-thread memory reused between searches; results do not depend on it.
struct PairWorkspace {
  /// A node or leaf of the wide tree, and the binary node that has its box.
  struct Place {
    std::uint32_t child = 0, source = 0;

    [[nodiscard]] bool leaf() const { return hierarchy::WideTree::is_leaf(child); }
    [[nodiscard]] std::uint32_t leaf_number() const { return hierarchy::WideTree::leaf_number(child); }
  };
  struct Entry {
    std::array<Place, 2> place;  ///< in the trees of O1 and O2; at first both roots
    float least = 0;             ///< lower bound on the distance; where boxes overlap, minus how far

    [[nodiscard]] bool leaves() const { return place[0].leaf() && place[1].leaf(); }
  };
  /// The nearest on top.
  class Heap {
   public:
    [[nodiscard]] bool empty() const { return entries_.empty(); }
    void clear() { entries_.clear(); }
    [[nodiscard]] const Entry& top() const { return entries_.front(); }
    void push(const Entry& entry) {
      entries_.push_back(entry);
      std::ranges::push_heap(entries_, std::greater{}, &Entry::least);
    }
    Entry pop() {
      std::ranges::pop_heap(entries_, std::greater{}, &Entry::least);
      const Entry entry = entries_.back();
      entries_.pop_back();
      return entry;
    }

   private:
    std::vector<Entry> entries_;
  };

  std::vector<Entry> overlapping;  ///< a stack
  Heap apart;
};

/// The closest points of the two surfaces, if their distance is at most `bound`. Cost: logarithmic where few
/// faces compete, at worst all pairs of faces that do; one thread, no allocation once the workspace has
/// grown.
[[nodiscard]] Separation find_closest(const MeshPair& pair, double bound, PairWorkspace& workspace);

/// Faces of the two surfaces that have a point in common, if any; decided exactly.
[[nodiscard]] Separation find_intersection(const MeshPair& pair, PairWorkspace& workspace);

}  // namespace sdm::exact
