// Parts of the surface of a body that leaves a solid.
#pragma once

#include <cstdint>
#include <limits>
#include <variant>
#include <vector>

#include "bodies/shape/node_ball.h"
#include "certify/depth/boundary_distance.h"
#include "search/branch_and_bound.h"

namespace sdm::depth {

struct NodePart {
  std::uint32_t node = 0;  ///< of the wide tree, or a leaf
};

/// A face, or a part of one that dividing it into quarters results in.
struct TrianglePart {
  Corners at{};
  CornerValues weights{};  ///< of the corners, at the centre of the part
  std::uint64_t step = 0;  ///< of Part::place: its quarters are a quarter step apart
  NearParts near{};        ///< found for the triangle, or for those that it is part of
  double gap = 0;          ///< between the bounds on the depth of the centre, in space
  double reach = std::numeric_limits<double>::infinity();  ///< the surface is no farther from the centre
  std::size_t known = 0;       ///< number of parts of the boundary that it may be bounded by
  std::uint32_t measured = 0;  ///< how often
  bool stale = true;           ///< whether it is still to be bounded by all of `near`
};

/// A node or a triangle of the surface of a body, in the frame of the solid.
struct Part {
  int body = 0;             ///< whose surface it is part of
  std::uint64_t place = 0;  ///< in the order of the tree
  shape::Ball
      ball{};  ///< contains the part; measured is its centre: of a triangle, where its bound is attained
  double upper = std::numeric_limits<double>::infinity();  ///< bound on the depth of its points, in space
  std::size_t exits = 0;  ///< number of exit directions that it is bounded by
  std::variant<NodePart, TrianglePart> what{};

  void limit(double bound) { upper = std::min(upper, bound); }
};

/// What is found at the centre of a part.
struct Value {
  BoundaryDistance b;  ///< 0 if it is outside
  NearParts near;
};

using Parts = search::Parts<Part, std::vector<Value>>;

}  // namespace sdm::depth
