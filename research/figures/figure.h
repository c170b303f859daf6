// A figure or table of the paper, reproduced.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace sdm::figures {

using Json = nlohmann::ordered_json;

/// A statement of the paper beside what this run measured, for the table at the top of the page.
struct Comparison {
  std::string what{}, paper{}, measured{};
};

struct Figure {
  std::string key{};                      ///< of report.json
  std::string title{};                    ///< plain text, as all below that is not HTML
  std::string paper{};                    ///< what the paper shows or states
  std::string measured{};                 ///< what this run shows
  std::vector<std::string> html{};        ///< pictures, charts and tables, by the functions of pieces.h
  std::vector<Comparison> comparisons{};  ///< may be empty
  /// Members: "paper", the numbers of the paper, and "measured". Times have keys that end in "_ms" and are
  /// the only values that differ between runs on the same machine.
  Json json = Json::object();
};

}  // namespace sdm::figures
