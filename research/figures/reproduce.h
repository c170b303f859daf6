// Re-runs the figures and tables of the paper.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "research/figures/figure.h"
#include "research/figures/machine.h"

namespace sdm::figures {

struct Options {
  /// Fewer frames, lower resolutions and fewer repetitions: for tests. The report says so.
  bool quick = false;
  /// The bunny; see scenes::SceneOptions::mesh.
  std::filesystem::path mesh{};
  /// Keys of the figures to run, of figure_keys(); empty: all.
  std::vector<std::string> only{};
  /// Called with the key of each figure before it runs, and during long ones. May throw, which ends the run.
  std::function<void(std::string_view)> step{};
};

struct Reproduction {
  Machine machine{};
  std::vector<Figure> figures{};
  double seconds = 0;  ///< of the whole run
  bool quick = false;
};

/// The keys of all figures, in the order of the report.
[[nodiscard]] std::vector<std::string> figure_keys();

/// Runs the figures. Throws sdm::Error if a mesh is missing, and what Options::step throws. Cost: minutes; a
/// few seconds if quick.
[[nodiscard]] Reproduction reproduce(const Options& options);

/// report.json: "version", "quick", "machine", "seconds", and a key for each figure.
[[nodiscard]] Json report_json(const Reproduction& reproduction);
/// report.html: one file that loads nothing.
[[nodiscard]] std::string report_page(const Reproduction& reproduction);

}  // namespace sdm::figures
