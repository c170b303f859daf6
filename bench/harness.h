// The framework of the benchmark programs: arguments, tables, JSON and the exit status. A case first verifies
// results and then measures times. Contenders that are compared take turns in one run (timing.h), so that
// ratios do not depend on changes in the machine's speed.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace sdm::bench {

/// A measured number; its key ends with the unit, if it has one.
struct Figure {
  std::string key;
  double value;
};

/// A row of a case's results.
struct Row {
  std::string name{};  ///< empty if the case has only one row
  std::vector<Figure> figures{};
};

struct Outcome {
  bool verified = false;         ///< whether the results were correct; if not, figures may be missing
  std::vector<Row> rows{};       ///< printed, and written as JSON
  std::vector<Figure> counts{};  ///< of the measured work; written as JSON only
};

/// The parameters of a case's run.
struct Trial {
  int repetitions;   ///< at least 1
  unsigned threads;  ///< the number of threads the library may use; 0: one per core
};

struct Case {
  std::string name, description;
  std::function<Outcome(const Trial&)> run;
  int repetitions = 9;   ///< by default
  unsigned threads = 1;  ///< by default
};

struct Program {
  std::string name, description;
  std::string repetition;  ///< what a repetition is, in the plural
  std::vector<Case> cases;
  std::function<void(CLI::App&)> add_options{};  ///< for the program's own options
};

/// What a benchmark program measures: the one function that it defines. main(), which all of them share,
/// parses the arguments --list, --filter REGEX, --repetitions N, --threads N and --json FILE, runs the
/// selected cases, and prints a Markdown table of their figures. The JSON file is written at the end:
///   {"program": ..., "machine": {"cpu": ..., "cores": ..., "compiler": ...},
///    "cases": {NAME: {"verified": ..., "repetitions": ..., "threads": ..., FIGURE: ..., ROW: {FIGURE:
///    ...}}}}
/// The exit status is 0; 1 if a result is wrong or something fails; 2 if the arguments are invalid.
[[nodiscard]] Program program();

}  // namespace sdm::bench
