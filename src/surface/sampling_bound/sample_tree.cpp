#include "surface/sampling_bound/sample_tree.h"

#include <algorithm>
#include <numeric>

#include "core/parallel.h"
#include "tree/visit.h"

namespace sdm::surface {

struct SampleTree::Run {
  std::size_t first;
  Box box;  // in the unit frame
};

SampleTree::SampleTree(const Surface& surface, double radius)
    : surface_(internals(surface)), frame_(UnitFrame::of(bounds(surface.mesh()))) {
  constexpr std::size_t kStride = 4096;
  const std::size_t count = surface_.samples.size();
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
  tree_ = tree::build_aabb_tree(boxes, std::move(runs), 1);
}

std::vector<SampleTree::Run> SampleTree::cut(std::size_t begin, std::size_t end, double radius) const {
  constexpr std::size_t kLongest = 128;
  std::vector<Vec3> points(end - begin);
  surface_.place_samples(begin, points);
  std::vector<Run> runs;
  for (std::size_t first = 0, next = 0; first < points.size(); first = next) {
    const Vec3 start = points[first];
    Vec3 lo = start, hi = start;
    for (next = first + 1; next < std::min(first + kLongest, points.size()); ++next) {
      const Vec3& p = points[next];
      if (squared_norm(p - start) > radius * radius) break;
      for (int k = 0; k < 3; ++k) {
        lo[k] = std::min(lo[k], p[k]);
        hi[k] = std::max(hi[k], p[k]);
      }
    }
    // Rounding is monotonic: this is the box of the points in the unit frame.
    runs.push_back({begin + first, {frame_.to_unit(lo), frame_.to_unit(hi)}});
  }
  return runs;
}

std::uint32_t SampleTree::nearest(const Vec3& query) const {
  const Vec3 unit_query = frame_.to_unit(query);
  std::uint32_t sample = 0;
  double least = kInfinity;  // squared
  const auto bound = [&](const tree::FloatBox& box) {
    return squared_norm((1 / frame_.scale) * gap(box, unit_query));  // exact: the scale is a power of two
  };
  const auto enter = [&](double squared_distance) { return squared_distance < least; };
  const auto visit_leaf = [&](std::uint32_t leaf) {
    const std::uint32_t run = tree_.items_of(leaf)[0];
    for (std::size_t i = first_[run]; i < first_[run + 1]; ++i) {
      const Vec3 p = surface_.texel_point(surface_.sample_faces[i], surface_.samples[i]);
      if (const double d = squared_norm(p - query); d < least) {
        sample = static_cast<std::uint32_t>(i);
        least = d;
      }
    }
  };
  tree::visit(tree_, tree::NearestFirst{bound, enter, visit_leaf});
  return sample;
}

}  // namespace sdm::surface
