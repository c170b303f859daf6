// Whether trees that were read from a file are trees.
#pragma once

#include <span>

#include "tree/aabb_tree.h"
#include "tree/wide_tree.h"

namespace sdm::tree {

/// Whether the nodes form one tree in depth-first order, not deeper than kDeepest, whose leaves divide the
/// items into runs of at most `leaf_size`. Boxes may be any (see below). Cost: linear.
[[nodiscard]] bool is_tree(const AabbTree& tree, std::uint32_t leaf_size);

/// Whether the nodes form one tree, parents before children, whose children stand for nodes of the binary
/// tree: those of a node divide the leaves of the one that it stands for. The binary tree must be one. Boxes
/// may be any. Cost: linear.
[[nodiscard]] bool is_tree(const WideTree& wide, const AabbTree& tree);

/// Whether each box contains those of its children, or that of its leaf in `leaves`, and the coordinates of
/// all of them are at most `reach`. It must be a tree with so many leaves. Cost: linear.
[[nodiscard]] bool have_valid_boxes(const AabbTree& tree, std::span<const FloatBox> leaves, float reach);
/// Whether the wide tree has the boxes of the binary one, and 0 in lanes without a child. Both must be trees.
/// Cost: linear.
[[nodiscard]] bool have_same_boxes(const WideTree& wide, const AabbTree& tree);

}  // namespace sdm::tree
