// Our maps against their peers: one case a row, measured side by side in one run, after the results have been
// verified at every texel. Compare ratios of medians; absolute times depend on the machine.
//
//   build/dev/bench/compare [CASE...] [--json FILE] [--list] [--repetitions N]
//
// Exits with 1 if a result is wrong.
#include <sdm/error.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cases.h"

namespace sdm::bench {
namespace {

/// Three digits, but all of those before the point.
std::string number(double value) {
  const int decimals = value < 10 ? 2 : value < 100 ? 1 : 0;
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

std::string number(const std::optional<double>& value) {
  return value ? number(*value) : "";
}

std::string asked(const Figure& figure) {
  if (figure.at_least) return "≥ " + number(*figure.at_least);
  if (figure.at_most) return "≤ " + number(*figure.at_most);
  return "";
}

const char* verdict(const Figure& figure) {
  if (!figure.at_least && !figure.at_most) return "";
  return figure.met() ? "yes" : "NO";
}

void print_heading() {
  std::puts(
      "| case | measured | | | asked | met | ours Mtexels/s | peer Mtexels/s | spread | verified |\n"
      "| --- | --- | --- | ---: | --- | --- | ---: | ---: | ---: | --- |");
}

void print_rows(const Case& test, const Outcome& outcome) {
  if (!outcome.verified)
    std::printf("| %s | %s | | | | | | | | NO |\n", test.name.c_str(), test.what.c_str());
  for (const Figure& figure : outcome.figures) {
    const bool first = &figure == &outcome.figures.front();
    std::printf("| %s | %s | %s | %s | %s | %s |", first ? test.name.c_str() : "",
                first ? test.what.c_str() : "", figure.key.c_str(), number(figure.value).c_str(),
                asked(figure).c_str(), verdict(figure));
    if (first)
      std::printf(" %s | %s | %s | yes |\n", number(outcome.ours_mtexels_s).c_str(),
                  number(outcome.peer_mtexels_s).c_str(),
                  outcome.spread ? (number(100 * *outcome.spread) + " %").c_str() : "");
    else
      std::puts(" | | | |");
  }
  std::fflush(stdout);
}

/// Counts of the search for each sixteen texels: they do not depend on the machine.
nlohmann::ordered_json per_packet(const cpu::DescentCounts& work, std::size_t texels) {
  const double packets = static_cast<double>(texels) / cpu::PointGroup::kPacket;
  const auto of = [&](std::size_t count) { return static_cast<double>(count) / packets; };
  return {{"groups", of(work.groups)},           {"nodes", of(work.nodes)},
          {"leaves", of(work.leaves)},           {"tree_sites", of(work.tree_sites)},
          {"list_blocks", of(work.list_blocks)}, {"evaluations", of(work.evaluations)}};
}

nlohmann::ordered_json to_json(const Outcome& outcome, int repetitions) {
  nlohmann::ordered_json json;
  json["verified"] = outcome.verified;
  if (!outcome.verified) return json;
  for (const Figure& figure : outcome.figures) {
    json[figure.key] = figure.value;
    if (figure.at_least) json["asked"][figure.key]["at_least"] = *figure.at_least;
    if (figure.at_most) json["asked"][figure.key]["at_most"] = *figure.at_most;
  }
  json["met"] = std::ranges::all_of(outcome.figures, &Figure::met);
  if (outcome.spread) json["spread"] = *outcome.spread;
  if (outcome.ours_mtexels_s) json["ours_mtexels_s"] = *outcome.ours_mtexels_s;
  if (outcome.peer_mtexels_s) json["peer_mtexels_s"] = *outcome.peer_mtexels_s;
  json["texels"] = outcome.texels;
  if (outcome.work) json["work_a_packet"] = per_packet(*outcome.work, outcome.texels);
  json["threads"] = outcome.threads;
  json["repetitions"] = repetitions;
  return json;
}

/// The cases of these names, in the table's order; all for no name.
std::vector<Case> choose(const std::vector<std::string>& names) {
  std::vector<Case> chosen;
  std::string known;
  for (const Case& test : cases()) {
    known += (known.empty() ? "" : ", ") + test.name;
    if (names.empty() || std::ranges::count(names, test.name) > 0) chosen.push_back(test);
  }
  for (const std::string& name : names)
    if (std::ranges::count(cases(), name, &Case::name) == 0)
      throw CLI::ValidationError("there is no case '" + name + "'; the cases are " + known, 2);
  return chosen;
}

int run(int argc, char** argv) {
  std::vector<std::string> names;
  std::string json_file;
  bool list = false;
  int repetitions = 0;
  std::vector<Case> chosen;
  CLI::App app{"Our maps against their peers"};
  app.failure_message([](const CLI::App*, const CLI::Error& error) {
    return std::string("compare: ") + error.what() + "\n";
  });
  app.add_option("CASE", names, "Cases to run; all by default");
  app.add_option("--json", json_file, "Write the results to this file");
  app.add_flag("--list", list, "List the cases and run none");
  app.add_option("--repetitions", repetitions, "Of every case, in place of its own number")
      ->check(CLI::Range(1, 1000));
  try {
    app.parse(argc, argv);
    chosen = choose(names);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }

  if (list) {
    for (const Case& test : chosen) std::printf("%-20s %s\n", test.name.c_str(), test.what.c_str());
    return 0;
  }
  const std::string unfinished = json_file + ".tmp";  // in its place when all is measured
  std::ofstream file;
  if (!json_file.empty()) file.open(unfinished);
  if (!file) throw Error("cannot write " + json_file);
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  bool good = true;
  print_heading();
  for (const Case& test : chosen) {
    const int n = repetitions > 0 ? repetitions : test.repetitions;
    std::fprintf(stderr, "%s: %s\n", test.name.c_str(), test.what.c_str());
    const Outcome outcome = test.run({test.name, n});
    print_rows(test, outcome);
    json[test.name] = to_json(outcome, n);
    good &= outcome.verified;
  }
  if (!json_file.empty()) {
    if (!(file << json.dump(2) << std::endl)) throw Error("cannot write " + unfinished);
    std::filesystem::rename(unfinished, json_file);
  }
  if (!good) std::fputs("compare: results are wrong, see above\n", stderr);
  return good ? 0 : 1;
}

}  // namespace
}  // namespace sdm::bench

int main(int argc, char** argv) try {
  return sdm::bench::run(argc, argv);
} catch (const std::exception& error) {
  std::fprintf(stderr, "compare: %s\n", error.what());
  return 1;
}
