#include <sdm/error.h>
#include <sdm/self_proximity_query.h>

#include <algorithm>
#include <cmath>
#include <new>

#include "core/geometry/triangle_pair.h"
#include "core/geometry/vec.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "core/rows.h"

namespace sdm {
namespace {

void check(const ExclusionRule& rule) {
  if (rule.rings == 0) throw Error("with 0 rings a face excludes only itself; use 1 or more");
  if (rule.geodesic && !(*rule.geodesic > 0 && std::isfinite(*rule.geodesic)))
    throw Error("a geodesic length of " + std::to_string(*rule.geodesic) +
                " is out of range; use a positive number");
}

// The faces reachable from each face through shared vertices.
class Neighbours {
 public:
  Neighbours(const Mesh& mesh, const ExclusionRule& rule)
      : mesh_(mesh),
        rule_(rule),
        around_(make_rows<std::uint32_t>(mesh.positions.size(), [&](const auto& put) {
          for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f)
            for (const std::uint32_t v : mesh.triangles[f]) put(v, f);
        })) {}

  // The marks of one thread; none is set between calls of `of`.
  struct Met {
    std::vector<bool> vertices, faces;
  };
  [[nodiscard]] Met none_met() const {
    return {std::vector<bool>(mesh_.positions.size()), std::vector<bool>(mesh_.triangles.size())};
  }

  // In increasing order.
  [[nodiscard]] std::vector<std::uint32_t> of(std::uint32_t face, Met& met) const {
    std::vector<std::uint32_t> reached{face}, rejected;
    met.faces[face] = true;
    std::size_t begin = 0;
    for (std::uint32_t ring = 1; begin < reached.size() && (rule_.geodesic || ring <= rule_.rings); ++ring)
      for (const std::size_t end = reached.size(); begin < end; ++begin)
        for (const std::uint32_t v : mesh_.triangles[reached[begin]]) {
          if (met.vertices[v]) continue;
          met.vertices[v] = true;
          for (const std::uint32_t other : around_.of(v)) {
            if (met.faces[other]) continue;
            met.faces[other] = true;
            const bool admitted = ring == 1 || !rule_.geodesic || within(*rule_.geodesic, face, other);
            (admitted ? reached : rejected).push_back(other);
          }
        }
    for (const std::uint32_t f : rejected) met.faces[f] = false;
    for (const std::uint32_t f : reached) {
      met.faces[f] = false;
      for (const std::uint32_t v : mesh_.triangles[f]) met.vertices[v] = false;
    }
    std::ranges::sort(reached);
    return reached;
  }

 private:
  [[nodiscard]] Corners corners(std::uint32_t face) const {
    const Triangle& t = mesh_.triangles[face];
    return {mesh_.positions[t[0]], mesh_.positions[t[1]], mesh_.positions[t[2]]};
  }
  [[nodiscard]] bool within(double length, std::uint32_t f, std::uint32_t g) const {
    const Corners a = corners(f), b = corners(g);
    const double most = length * length;
    // Corners or boxes decide in nearly all cases.
    for (const Vec3& p : a)
      for (const Vec3& q : b)
        if (squared_norm(q - p) < most) return true;
    return squared_box_distance(a, b) < most && closest_or_common(a, b).squared < most;
  }

  const Mesh& mesh_;
  const ExclusionRule& rule_;
  CompressedRows<std::uint32_t> around_;  // faces of each vertex
};

}  // namespace

Exclusion::Exclusion(const Mesh& rest, const ExclusionRule& rule, const Progress& progress) try {
  validate(rest);
  check(rule);
  const std::size_t count = rest.triangles.size();
  const Neighbours neighbours(rest, rule);
  offsets_.assign(1, 0);

  // Faces are processed in portions whose neighbourhoods, however large, take a bounded amount of memory: the
  // total is checked before it is stored.
  constexpr std::size_t kEntries = std::size_t{1} << 26, kGrain = 256;
  const std::size_t block = std::clamp<std::size_t>(kEntries / count, 1, std::size_t{1} << 16);
  std::vector<std::vector<std::uint32_t>> rows(std::min(block, count));
  for (std::size_t first = 0; first < count; first += block) {
    const std::size_t end = std::min(count, first + block);
    parallel_for(end - first, kGrain, [&](std::size_t begin, std::size_t last) {
      Neighbours::Met met = neighbours.none_met();
      for (std::size_t i = begin; i < last; ++i)
        rows[i] = neighbours.of(static_cast<std::uint32_t>(first + i), met);
    });
    for (std::size_t i = 0; i < end - first; ++i) offsets_.push_back(offsets_.back() + rows[i].size());
    if (offsets_.back() > excluded_.capacity()) {
      const std::size_t room = std::max(offsets_.back(), 2 * excluded_.capacity());
      require_memory(room * sizeof(std::uint32_t), "the excluded neighbourhoods of all faces");
      excluded_.reserve(room);
    }
    for (std::size_t i = 0; i < end - first; ++i)
      excluded_.insert(excluded_.end(), rows[i].begin(), rows[i].end());
    if (progress && !progress("neighbourhoods", static_cast<double>(end) / static_cast<double>(count)))
      throw Cancelled();
  }
  if (rule.geodesic) keep_mutual();
} catch (const std::bad_alloc&) {
  throw out_of_memory("the excluded neighbourhoods of all faces");
}

// Keeps only mutual exclusions: the search from g may miss f although the search from f finds g.
void Exclusion::keep_mutual() {
  std::vector<std::uint8_t> mutual(excluded_.size());
  constexpr std::size_t kGrain = 1024;
  parallel_for(faces(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f)
      for (std::size_t i = offsets_[f]; i < offsets_[f + 1]; ++i)
        mutual[i] = std::ranges::binary_search(of(excluded_[i]), static_cast<std::uint32_t>(f));
  });
  std::size_t kept = 0;
  for (std::size_t f = 0, i = 0; f < faces(); ++f) {
    for (; i < offsets_[f + 1]; ++i)
      if (mutual[i]) excluded_[kept++] = excluded_[i];
    offsets_[f + 1] = kept;
  }
  excluded_.resize(kept);
}

}  // namespace sdm
