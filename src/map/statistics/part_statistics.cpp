#include <sdm/error.h>
#include <sdm/mesh_attributes.h>
#include <sdm/statistics.h>
#include <sdm/tolerance.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/disjoint_sets.h"
#include "core/memory.h"
#include "geometry/vec.h"
#include "map/statistics/tolerance_limits.h"
#include "map/statistics/weighted_statistics.h"
#include "map/statistics/weighted_texels.h"

namespace sdm {
namespace {

using map::WeightedTexels;

struct Sample {
  float distance, weight;
};

// The texels of each part, in the order of the atlas: those of part p from begin[p] to begin[p + 1].
struct SamplesByPart {
  std::vector<Sample> samples;
  std::vector<std::size_t> begin;
  double area = 0;  ///< of all texels, including those of no part

  [[nodiscard]] std::span<const Sample> of(std::size_t part) const {
    return std::span(samples).subspan(begin[part], begin[part + 1] - begin[part]);
  }
};

SamplesByPart samples_by_part(const WeightedTexels& texels, std::span<const std::uint32_t> part_of_face,
                              std::size_t parts) {
  SamplesByPart result;
  result.begin.assign(parts + 2, 0);
  const auto visit_all = [&](const auto& visit) {
    for (std::size_t i = 0; i < WeightedTexels::kParts; ++i)
      texels.for_each(i, [&](float d, float weight, std::uint32_t face) {
        if (const std::uint32_t part = part_of_face[face]; part != kNone) visit(part, Sample{d, weight});
      });
  };
  result.area = [&] {
    struct Area {
      double sum = 0;
      void operator+=(const Area& other) { sum += other.sum; }
    };
    return WeightedTexels::sum<Area>([&](std::size_t i) {
             Area area;
             texels.for_each(i, [&](float, float weight, std::uint32_t) { area.sum += weight; });
             return area;
           })
        .sum;
  }();
  // A counting sort; begin[p + 1] first counts part p, then is where its next sample goes.
  visit_all([&](std::uint32_t part, const Sample&) { ++result.begin[part + 2]; });
  for (std::size_t i = 2; i < result.begin.size(); ++i) result.begin[i] += result.begin[i - 1];
  result.samples.resize(result.begin.back());
  visit_all([&](std::uint32_t part, const Sample& s) { result.samples[result.begin[part + 1]++] = s; });
  result.begin.pop_back();
  return result;
}

void measure(std::span<const Sample> samples, double all_area, const std::optional<Tolerance>& tolerance,
             double accuracy, PartStatistics& part) {
  constexpr std::size_t kSamplesPerPiece = 1 << 16;
  const std::size_t pieces =
      std::clamp<std::size_t>(samples.size() / kSamplesPerPiece, 1, WeightedTexels::kParts);
  part.distance = map::weighted_statistics(pieces, [&](std::size_t piece, const auto& visit) {
    const std::size_t end = (piece + 1) * samples.size() / pieces;
    for (std::size_t i = piece * samples.size() / pieces; i < end; ++i)
      if (std::isfinite(samples[i].distance)) visit(samples[i].distance, samples[i].weight);
  });

  const map::ToleranceLimits limits(tolerance.value_or(Tolerance()), accuracy);
  double area = 0;
  ToleranceShares shares;
  for (const auto& [d, weight] : samples) {
    area += weight;
    if (!tolerance) continue;
    (!std::isfinite(d) ? shares.without_value
     : limits.below(d) ? shares.below
     : limits.above(d) ? shares.above
                       : shares.within) += weight;
  }
  part.area_fraction = all_area > 0 ? area / all_area : 0;
  if (area > 0)
    for (double* share : {&shares.below, &shares.within, &shares.above, &shares.without_value})
      *share /= area;
  if (tolerance) part.tolerance = shares;
}

}  // namespace

NamedFaces faces_named(std::span<const FaceNames> names, const std::string& name) {
  for (const FaceNames& kind : names) {
    const auto number = static_cast<std::uint32_t>(std::ranges::find(kind.names, name) - kind.names.begin());
    NamedFaces result{.kind = kind.kind, .faces = {}};
    if (number < kind.names.size())
      for (std::uint32_t f = 0; f < kind.of_face.size(); ++f)
        if (kind.of_face[f] == number) result.faces.push_back(f);
    if (!result.faces.empty()) return result;
  }
  return {};
}

std::vector<NamedFaces> faces_of_groups(std::span<const FaceNames> names,
                                        std::span<const GroupTolerance> table) {
  std::vector<NamedFaces> result(table.size());
  std::unordered_map<std::string_view, std::vector<std::size_t>> rows_of;
  for (std::size_t row = 0; row < table.size(); ++row) rows_of[table[row].group].push_back(row);
  for (const FaceNames& kind : names) {
    std::vector<std::vector<std::uint32_t>*> faces_of(kind.names.size());
    std::vector<std::pair<std::size_t, std::size_t>> copies;  // rows of the same name
    for (std::size_t n = 0; n < kind.names.size(); ++n) {
      const auto rows = rows_of.find(kind.names[n]);
      if (rows == rows_of.end()) continue;
      std::optional<std::size_t> first;
      for (const std::size_t row : rows->second) {
        const bool is_asked =
            table[row].kind.empty() ? result[row].faces.empty() : table[row].kind == kind.kind;
        if (!is_asked) continue;
        result[row].kind = kind.kind;
        if (first)
          copies.emplace_back(*first, row);
        else {
          first = row;
          faces_of[n] = &result[row].faces;
        }
      }
    }
    for (std::uint32_t f = 0; f < kind.of_face.size(); ++f)
      if (const std::uint32_t n = kind.of_face[f]; n != kNone && faces_of[n] != nullptr)
        faces_of[n]->push_back(f);
    for (const auto& [first, row] : copies) result[row] = result[first];
  }
  for (NamedFaces& row : result)
    if (row.faces.empty()) row.kind.clear();
  return result;
}

std::vector<GroupTolerance> with_kinds(std::span<const FaceNames> names,
                                       std::span<const GroupTolerance> table) {
  std::vector<GroupTolerance> result(table.begin(), table.end());
  const std::vector<NamedFaces> named = faces_of_groups(names, table);
  for (std::size_t row = 0; row < result.size(); ++row) result[row].kind = named[row].kind;
  return result;
}

std::vector<FaceNames> names_of_part(std::span<const FaceNames> names,
                                     std::span<const std::uint32_t> source_face) {
  std::vector<FaceNames> result(names.begin(), names.end());
  if (source_face.empty()) return result;
  for (std::size_t k = 0; k < names.size(); ++k) {
    result[k].of_face.clear();
    for (const std::uint32_t face : source_face) result[k].of_face.push_back(names[k].of_face[face]);
  }
  return result;
}

std::string names_text(std::span<const FaceNames> names) {
  constexpr std::size_t kMost = 20;
  std::string text;
  std::size_t count = 0;
  for (const FaceNames& kind : names)
    for (const std::string& name : kind.names) {
      if (++count > kMost) return "its names are " + text + ", ...";
      text += (text.empty() ? "" : ", ") + name;
    }
  return text.empty() ? "its faces have no names" : "its names are " + text;
}

std::vector<std::uint32_t> face_components(const Mesh& mesh) try {
  DisjointSets sets(mesh.positions.size());
  for (const Triangle& t : mesh.triangles) {
    if (is_removed(t)) continue;
    sets.unite(t[0], t[1]);
    sets.unite(t[1], t[2]);
  }
  std::vector<std::uint32_t> number(mesh.positions.size(), kNone);  // of each representative
  std::vector<std::uint32_t> components(mesh.triangles.size(), kNone);
  std::uint32_t count = 0;
  for (std::size_t f = 0; f < components.size(); ++f) {
    if (is_removed(mesh.triangles[f])) continue;
    std::uint32_t& component = number[sets.find(mesh.triangles[f][0])];
    if (component == kNone) component = count++;
    components[f] = component;
  }
  return components;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the components of a mesh");
}

std::vector<PartStatistics> part_statistics(const Surface& surface, const DistanceMap& map,
                                            std::span<const std::uint32_t> part_of_face, std::size_t parts,
                                            const PartStatisticsOptions& options) try {
  const std::vector<Triangle>& triangles = surface.mesh().triangles;
  if (part_of_face.size() != triangles.size())
    throw Error("part_statistics() needs one part for each face of the surface's mesh");
  std::vector<PartStatistics> result(parts);
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    const std::uint32_t number = part_of_face[f];
    if (number == kNone || is_removed(triangles[f])) continue;
    if (number >= parts) throw Error("part_statistics() needs numbers of parts below their count");
    PartStatistics& part = result[number];
    ++part.faces;
    for (const std::uint32_t v : triangles[f]) extend(part.box, surface.mesh().positions[v]);
  }
  const SamplesByPart samples = samples_by_part(WeightedTexels(surface, map), part_of_face, parts);
  parallel_for(parts, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p)
      measure(samples.of(p), samples.area, options.tolerance, options.accuracy, result[p]);
  });
  return result;
} catch (const std::bad_alloc&) {
  throw out_of_memory("the statistics of parts");
}

}  // namespace sdm
