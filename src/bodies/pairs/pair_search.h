// The closest faces of two surfaces, by traversing both trees: only triangles that are compared are
// transformed.
#pragma once

#include <algorithm>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "bodies/pairs/mesh_pair.h"
#include "tree/visit.h"

namespace sdm::pairs {

/// Per-thread memory, reused between searches; results do not depend on it.
struct PairWorkspace {
  struct Entry {
    std::array<tree::Place, 2> place;  ///< in the trees of O1 and O2; initially both roots
    float least = 0;  ///< lower bound on the distance; if the boxes overlap, minus the depth of the overlap

    [[nodiscard]] bool leaves() const { return place[0].leaf() && place[1].leaf(); }
    /// Pairs equally near follow each other in the order of the trees.
    bool operator>(const Entry& other) const {
      if (least != other.least) return least > other.least;
      return std::pair(place[0].child, place[1].child) >
             std::pair(other.place[0].child, other.place[1].child);
    }
  };
  /// A heap with the nearest pair on top.
  class Heap {
   public:
    [[nodiscard]] bool empty() const { return entries_.empty(); }
    void clear() { entries_.clear(); }
    [[nodiscard]] const Entry& top() const { return entries_.front(); }
    void push(const Entry& entry) {
      entries_.push_back(entry);
      std::push_heap(entries_.begin(), entries_.end(), std::greater{});
    }
    Entry pop() {
      std::pop_heap(entries_.begin(), entries_.end(), std::greater{});
      const Entry entry = entries_.back();
      entries_.pop_back();
      return entry;
    }

   private:
    std::vector<Entry> entries_;
  };

  /// Faces by their position in the order of the trees, and a lower bound on their distance.
  struct Candidate {
    float least;
    std::uint32_t owner1, owner2;
  };
  /// Faces that may be closest, and their distance.
  struct Tie {
    double distance;
    FacePair faces;
  };

  /// A node, and a lower bound on its extent in a direction.
  struct Ahead : tree::Place {
    float bound = -std::numeric_limits<float>::infinity();

    static Ahead of(const Ahead& parent, const tree::WideTree::Node& node, std::uint32_t i, float bound) {
      return {Place::of(node, parent.child, i), bound};
    }
  };

  std::vector<Entry> overlapping;  ///< a stack
  std::vector<Ahead> ahead;        ///< a stack
  Heap apart;
  std::vector<Candidate> candidates;  ///< still to be compared
  std::vector<Tie> ties;              ///< at the smallest distance found so far, to rounding
};

/// Finds the closest points of the two surfaces, if their distance is at most `bound`. Of several pairs of
/// faces at the same distance, to rounding, the one with the smallest numbers.
///
/// `hint`: faces of O1 and O2 that may be close to each other; they change how long the search takes, not its
/// result. Cost: logarithmic if few faces are candidates, in the worst case all pairs of candidates;
/// single-threaded, without allocation once the workspace has grown.
[[nodiscard]] Separation find_closest(const MeshPair& pair, double bound, PairWorkspace& workspace,
                                      const FacePair& hint = kNoFaces);

/// Finds two faces, one of each surface, that have a point in common; kNoFaces if there are none. Decided
/// exactly. `hint`: faces that may be such ones, which are then the result.
[[nodiscard]] FacePair find_common_faces(const MeshPair& pair, PairWorkspace& workspace,
                                         const FacePair& hint = kNoFaces);
/// Finds faces that intersect, without a hint, with a point that they have in common; for surfaces that
/// probably intersect: no separating axis is tried.
[[nodiscard]] Separation find_intersection(const MeshPair& pair, PairWorkspace& workspace);

}  // namespace sdm::pairs
