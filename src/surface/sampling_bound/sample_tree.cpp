#include "surface/sampling_bound/sample_tree.h"

#include <algorithm>
#include <numeric>

#include "core/parallel.h"
#include "core/vec.h"

namespace sdm::surface {

struct SampleTree::Run {
  std::size_t first;
  Box box;  // in the unit frame
};

struct SampleTree::Nearest {
  Vec3 query, unit_query;
  std::uint32_t sample = 0;
  double squared_distance = std::numeric_limits<double>::infinity();
};

SampleTree::SampleTree(const Surface& surface, double radius)
    : points_(surface.sample_points()), frame_(UnitFrame::of(bounds(surface.mesh()))) {
  constexpr std::size_t kStride = 4096;
  const std::size_t count = points_.size();
  std::vector<std::vector<Run>> parts((count + kStride - 1) / kStride);
  parallel_for(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      parts[i] = cut(i * kStride, std::min(count, (i + 1) * kStride), radius);
  });
  std::vector<Box> boxes;
  for (const std::vector<Run>& part : parts)
    for (const Run& run : part) {
      first_.push_back(run.first);
      boxes.push_back(run.box);
    }
  first_.push_back(count);
  std::vector<std::uint32_t> runs(boxes.size());
  std::iota(runs.begin(), runs.end(), 0u);
  tree_ = hierarchy::build_aabb_tree(boxes, std::move(runs), 1);
}

std::vector<SampleTree::Run> SampleTree::cut(std::size_t begin, std::size_t end, double radius) const {
  constexpr std::size_t kLongest = 64;
  std::vector<Run> runs;
  Vec3 start{};
  for (std::size_t i = begin; i < end; ++i) {
    const Vec3 p = points_[i];
    if (runs.empty() || i - runs.back().first == kLongest || norm(p - start) > radius) {
      runs.push_back({i, {}});
      start = p;
    }
    extend(runs.back().box, frame_.to_unit(p));
  }
  return runs;
}

std::uint32_t SampleTree::nearest(const Vec3& query) const {
  Nearest found{query, frame_.to_unit(query)};
  descend(0, found);
  return found.sample;
}

double SampleTree::squared_distance(std::uint32_t node, const Nearest& found) const {
  const hierarchy::FloatBox& box = tree_.nodes[node].box;
  Vec3 gap;
  for (int k = 0; k < 3; ++k)
    gap[k] = std::max({box.lo[k] - found.unit_query[k], 0.0, found.unit_query[k] - box.hi[k]}) / frame_.scale;
  return squared_norm(gap);
}

void SampleTree::descend(std::uint32_t index, Nearest& found) const {
  const hierarchy::AabbTree::Node& node = tree_.nodes[index];
  if (node.leaf()) {
    const std::uint32_t run = tree_.items[node.first];
    for (std::size_t i = first_[run]; i < first_[run + 1]; ++i) {
      const double d = squared_norm(points_[i] - found.query);
      if (d < found.squared_distance)
        found.sample = static_cast<std::uint32_t>(i), found.squared_distance = d;
    }
    return;
  }
  const std::array<std::uint32_t, 2> children{index + 1, node.right};
  const std::array<double, 2> distances{squared_distance(children[0], found),
                                        squared_distance(children[1], found)};
  const int near = distances[0] <= distances[1] ? 0 : 1;
  for (const int k : {near, 1 - near})
    if (distances[k] < found.squared_distance) descend(children[k], found);
}

}  // namespace sdm::surface
