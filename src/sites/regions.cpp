#include "sites/regions.h"

#include <algorithm>
#include <cmath>

#include "core/atomic_extremes.h"
#include "core/parallel.h"
#include "geometry/rounding.h"
#include "geometry/vec.h"
#include "sites/compute_regions.h"

namespace sdm::sites {
namespace {

constexpr std::size_t kVertices = 4096, kLeaves = 128;  // grains

// The slope of the bounds of a face and the sites it owns, from the smallest cosine of the angles between its
// normal and those of the faces around it.
float slope_of(double cosine) {
  constexpr double kSteepest = 20;  // steeper slopes count as open
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  if (!(sine < kSteepest * cosine)) return FaceBounds::kOpen;
  return static_cast<float>((1 + kSingleRounding) * (sine / cosine) + kSingleRounding);
}

// Computes what depends on the normals of the faces around a site: the slopes of a leaf's bounds, and the
// pseudonormals of the vertices that its faces own.
void look_around(Regions& regions, std::size_t leaf, std::span<const FaceShape> shapes,
                 Pseudonormals& normals) {
  const SitePlaces& places = regions.places;
  unsigned thin_faces = 0;
  for (std::uint32_t i = regions.leaves[leaf]; i < regions.leaves[leaf + 1]; ++i) {
    const Regions::Owner &own = regions.owners[i], &next = regions.owners[i + 1];
    double least_cosine = regions.enclosed[i] ? 1 : -1;
    bool thin = shapes[i].thin;
    thin_faces |= unsigned{thin} << (i - regions.leaves[leaf]);
    const auto include = [&](const FaceShape& other) {
      least_cosine = std::min(least_cosine, dot(shapes[i].normal, other.normal));
      thin |= other.thin;
    };
    for (std::uint32_t e = own.edges; e < next.edges; ++e)
      for (const std::uint32_t face : places.edges[e].faces) include(shapes[face]);
    for (std::uint32_t v = own.vertices; v < next.vertices; ++v) {
      Vec3 sum{};
      for (const std::uint32_t corner : places.fans.of(v)) {
        const FaceShape& shape = shapes[corner / 4];
        sum += shape.angle[corner % 4] * shape.normal;
        include(shape);
      }
      normals.vertex[regions.vertices[v].vertex] = sum;
    }
    regions.bounds[leaf].slope[i - regions.leaves[leaf]] = slope_of(thin ? -1 : least_cosine);
  }
  regions.thin[leaf] = static_cast<std::uint8_t>(thin_faces);
}

}  // namespace

void place(const Regions& regions, std::span<const Vec3> positions, std::vector<Vec3>& placed) {
  placed.resize(regions.points.size());
  parallel_for(placed.size(), kVertices, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) placed[v] = positions[regions.points[v].vertex];
  });
}

void find_leaf_boxes(const Regions& regions, const UnitFrame& frame, std::span<const Vec3> placed,
                     std::vector<tree::FloatBox>& boxes) {
  boxes.resize(regions.leaves.size() - 1);
  parallel_for(boxes.size(), kLeaves, [&](std::size_t begin, std::size_t end) {
    for (std::size_t leaf = begin; leaf < end; ++leaf) {
      Box box;
      for (std::uint32_t i = regions.leaves[leaf]; i < regions.leaves[leaf + 1]; ++i)
        for (const std::uint32_t v : regions.places.corners[i]) extend(box, placed[v]);
      boxes[leaf] = tree::FloatBox::around({frame.to_unit(box.lower), frame.to_unit(box.upper)});
    }
  });
}

void refit(Regions& regions, const Placement& placement, Pseudonormals& normals, Array<std::uint8_t>& sliver,
           std::vector<FaceShape>& shapes) {
  shapes.resize(regions.faces.size());
  parallel_for(regions.bounds.size(), kLeaves, [&](std::size_t begin, std::size_t end) {
    compute_faces(regions, placement, shapes, begin, end);
    for (std::uint32_t i = regions.leaves[begin]; i < regions.leaves[end]; ++i) {
      const std::uint32_t face = regions.owners[i].face;
      normals.face[face] = shapes[i].normal;
      sliver[face] = shapes[i].sliver;
    }
  });
  regions.largest_radius = 0;
  parallel_for(regions.bounds.size(), kLeaves, [&](std::size_t begin, std::size_t end) {
    const Regions::Owner &first = regions.owners[regions.leaves[begin]],
                         &last = regions.owners[regions.leaves[end]];
    compute_edges(regions, placement, first.edges, last.edges);
    compute_vertices(regions, placement, first.vertices, last.vertices);
    float largest = 0;
    for (std::size_t leaf = begin; leaf < end; ++leaf) {
      look_around(regions, leaf, shapes, normals);
      const std::uint32_t count = regions.leaves[leaf + 1] - regions.leaves[leaf];
      largest = std::max(largest,
                         *std::max_element(regions.bounds[leaf].radius, regions.bounds[leaf].radius + count));
    }
    atomic_max(regions.largest_radius, largest);
  });
}

}  // namespace sdm::sites
