#include "harness.h"

#include <sdm/error.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <regex>

#include "report.h"

namespace sdm::bench {
namespace {

struct Arguments {
  bool list = false;
  std::string filter, json_file;
  int repetitions = 0;  // 0: the case's own number
  int threads = -1;     // -1: the case's own number
};

void add_options(CLI::App& app, const Program& program, Arguments& arguments) {
  app.failure_message([&program](const CLI::App*, const CLI::Error& error) {
    return program.name + ": " + error.what() + "\n";
  });
  app.add_flag("--list", arguments.list, "List the cases and run none");
  app.add_option("--filter", arguments.filter,
                 "Run the cases whose names contain a match of this regular expression")
      ->option_text("REGEX");
  app.add_option("--repetitions", arguments.repetitions,
                 "Number of " + program.repetition + ", in place of each case's own")
      ->check(CLI::Range(1, 100000));
  app.add_option("--threads", arguments.threads,
                 "Threads that the library may use, 0 for one per core, in place of each case's own")
      ->check(CLI::Range(0, 1024));
  app.add_option("--json", arguments.json_file, "Write the results to this file")->option_text("FILE");
  if (program.add_options) program.add_options(app);
}

std::vector<Case> choose(const std::vector<Case>& cases, const std::string& filter) {
  std::vector<Case> chosen;
  try {
    const std::regex pattern(filter);
    for (const Case& test : cases)
      if (std::regex_search(test.name, pattern)) chosen.push_back(test);
  } catch (const std::regex_error&) {
    throw CLI::ValidationError("'" + filter + "' is not a regular expression", 2);
  }
  if (chosen.empty()) throw CLI::ValidationError("no case matches '" + filter + "'; see --list", 2);
  return chosen;
}

int run(int argc, char** argv, const Program& program) {
  Arguments arguments;
  CLI::App app{program.description};
  std::vector<Case> chosen;
  try {
    add_options(app, program, arguments);
    app.parse(argc, argv);
    chosen = choose(program.cases, arguments.filter);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (arguments.list) {
    for (const Case& test : chosen) std::printf("%-31s %s\n", test.name.c_str(), test.description.c_str());
    return 0;
  }

  JsonReport json(program.name, arguments.json_file);
  Table table;
  bool verified = true;
  for (const Case& test : chosen) {
    std::fprintf(stderr, "%s: %s\n", test.name.c_str(), test.description.c_str());
    const Trial trial{
        .repetitions = arguments.repetitions > 0 ? arguments.repetitions : test.repetitions,
        .threads = arguments.threads >= 0 ? static_cast<unsigned>(arguments.threads) : test.threads};
    const Outcome outcome = test.run(trial);
    table.print(test.name, outcome);
    json.add(test.name, trial, outcome);
    verified &= outcome.verified;
    if (!outcome.verified) std::fprintf(stderr, "%s: wrong results\n", test.name.c_str());
  }
  json.commit();
  return verified ? 0 : 1;
}

}  // namespace
}  // namespace sdm::bench

int main(int argc, char** argv) {
  std::string name = argv[0];
  try {
    const sdm::bench::Program program = sdm::bench::program();
    name = program.name;
    return sdm::bench::run(argc, argv, program);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", name.c_str(), error.what());
    return 1;
  }
}
