// The cases of `compare`.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/cpu/descent.h"

namespace sdm::bench {

/// A number that a case measures.
struct Figure {
  std::string key{};
  double value = 0;
  std::optional<double> at_least{}, at_most{};

  [[nodiscard]] bool met() const {
    return !(at_least && !(value >= *at_least)) && !(at_most && !(value <= *at_most));
  }
};

struct Outcome {
  bool verified = false;          ///< whether the results were verified; nothing is timed otherwise
  std::vector<Figure> figures{};  ///< the case's own first
  std::size_t texels = 0;         ///< of our map or maps
  unsigned threads = 1;           ///< of ours
  /// Of the first figure, if that is a ratio of times: (third − first quartile) / median of repetitions'.
  std::optional<double> spread{};
  std::optional<double> ours_mtexels_s{}, peer_mtexels_s{};
  std::optional<cpu::DescentCounts> work{};  ///< of our search
};

/// How a case is run.
struct Trial {
  std::string name;  ///< of the case, for its progress
  int repetitions = 0;
};

struct Case {
  std::string name, what;
  int repetitions = 9;  ///< unless told otherwise
  std::function<Outcome(const Trial&)> run;
};

[[nodiscard]] std::span<const Case> cases();

}  // namespace sdm::bench
