// The distances of a body to the other one in a frame of `sdm sequence`.
#pragma once

#include <sdm/sdm.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

struct FrameDistances {
  double min = 0, mean = 0, max = 0;      ///< of texels and vertices; `mean` of texels, weighted by area
  std::optional<sdm::Verdict> verdict{};  ///< of the tolerance, if there is one
  double exceeded_area_fraction = 0;      ///< of it
  bool certified = false;                 ///< the verdict is proven
  double guard = 0;                       ///< Evidence::guard of the verdict
  std::optional<sdm::Doubt> doubt{};      ///< that it leaves

  [[nodiscard]] sdm::Verdict judged() const { return verdict.value_or(sdm::Verdict::pass); }
  /// Makes a PASS doubtful.
  void withhold_pass();
};

/// Summarises the map on `surface` to `sites`; the accuracy of the options is that of the engine. Throws
/// sdm::Error if the tolerance needs signs and there are none. Cost: closest points of the vertices, linear,
/// and that of a proof where the map does not decide.
[[nodiscard]] FrameDistances frame_distances(const sdm::Surface& surface, const sdm::Sites& sites,
                                             const sdm::DistanceMap& map,
                                             const std::optional<sdm::Tolerance>& tolerance,
                                             sdm::CertifyOptions options);

[[nodiscard]] nlohmann::ordered_json to_json(const FrameDistances& distances);
/// The inverse.
[[nodiscard]] FrameDistances distances_from(const nlohmann::ordered_json& json);

/// The columns of frames.csv, after a comma, for the body with this name, "o1" or "o2"; and their cells.
[[nodiscard]] std::string distance_columns(const std::string& body);
[[nodiscard]] std::vector<std::string> cells(const std::optional<FrameDistances>& distances);
