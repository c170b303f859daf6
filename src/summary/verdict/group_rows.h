// The rows of a table of tolerances that faces have.
#pragma once

#include <sdm/error.h>
#include <sdm/tolerance.h>
#include <sdm/verdict.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace sdm::summary {

/// The rows whose names faces have, in the order of the table; others are left out. A face may have several
/// of the names, as those of an object and of a material: rows are in *layers*, in each of which a face has
/// one row at most.
struct GroupRows {
  struct Row {
    NamedFaces named;
    GroupTolerance group;
    std::size_t layer = 0;
    std::uint32_t number = 0;  ///< in its layer
  };
  struct Layer {
    std::vector<std::uint32_t> of_face;  ///< the number in the layer, or kNone
    std::size_t count = 0;
  };
  std::vector<Row> rows;
  std::vector<Layer> layers;

  GroupRows(std::span<const FaceNames> names, std::span<const GroupTolerance> table, std::size_t faces) {
    std::vector<NamedFaces> named = faces_of_groups(names, table);
    for (std::size_t i = 0; i < table.size(); ++i) {
      if (named[i].faces.empty()) continue;
      Row row{.named = std::move(named[i]), .group = table[i]};
      const auto is_free = [&](const Layer& layer) {
        return std::ranges::all_of(row.named.faces, [&](auto f) { return layer.of_face[f] == kNone; });
      };
      const auto layer = std::ranges::find_if(layers, is_free);
      row.layer = static_cast<std::size_t>(layer - layers.begin());
      if (layer == layers.end()) layers.push_back({std::vector<std::uint32_t>(faces, kNone), 0});
      row.number = static_cast<std::uint32_t>(layers[row.layer].count++);
      for (const std::uint32_t face : row.named.faces) layers[row.layer].of_face[face] = row.number;
      rows.push_back(std::move(row));
    }
  }
};

/// Throws sdm::Error for a tolerance that needs a sign where distances have none.
inline void check_sign(const GroupTolerance& group, const SignUsed& sign) {
  if (group.tolerance.needs_sign() && sign.method == SignMethod::none)
    throw Error("the tolerance of group " + group.group +
                " differs by sign, but the distances are unsigned: " + sign.reason);
}

/// The verdict on all groups.
[[nodiscard]] inline Verdict worst_of(std::span<const GroupVerdict> groups, bool doubted) {
  for (const Verdict verdict : {Verdict::fail, Verdict::not_decided, Verdict::doubtful})
    if (std::ranges::any_of(groups, [&](const GroupVerdict& g) { return g.verdict.verdict == verdict; }))
      return verdict;
  return doubted ? Verdict::doubtful : Verdict::pass;
}

}  // namespace sdm::summary
