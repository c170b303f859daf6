// Prints and writes the outcomes of cases.
#pragma once

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "harness.h"

namespace sdm::bench {

/// Prints outcomes as rows of Markdown tables on stdout. Consecutive rows with the same keys share a heading.
class Table {
 public:
  void print(const std::string& name, const Outcome& outcome);

 private:
  void print_heading(const Row& row);

  std::vector<std::string> keys_;  ///< of the latest heading
};

/// The JSON file written by main().
class JsonReport {
 public:
  /// If the file name is empty, writes nothing. Throws Error if the file cannot be written.
  JsonReport(const std::string& program, std::string file_name);

  void add(const std::string& name, const Trial& trial, const Outcome& outcome);

  /// Moves the file to its final name. Throws Error if it cannot be written.
  void commit();

 private:
  std::string file_name_, unfinished_;
  std::ofstream file_;
  nlohmann::ordered_json json_;
};

}  // namespace sdm::bench
