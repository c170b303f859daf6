// Whether trees that were read from a file are trees.
#pragma once

#include <cstdint>

#include "tree/aabb_tree.h"
#include "tree/wide_tree.h"

namespace sdm::tree {

/// Whether the nodes form one tree in depth-first order, not deeper than kDeepest, whose leaves divide the
/// items into runs of at most `leaf_size`; each box contains those of its children, and no coordinate is
/// beyond `reach`. Cost: linear.
[[nodiscard]] bool is_tree(const AabbTree& tree, std::uint32_t leaf_size, float reach);

/// Whether the nodes form one tree, parents before children, whose children stand for nodes of the binary
/// tree and have their boxes: those of a node divide the leaves of the one that it stands for. The binary
/// tree must be one. Cost: linear.
[[nodiscard]] bool is_tree(const WideTree& wide, const AabbTree& tree);

}  // namespace sdm::tree
