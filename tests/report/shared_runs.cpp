#include "report/shared_runs.h"

#include <map>

#include "cli/samples.h"
#include "support/temporary_folder.h"

namespace sdm::test {
namespace {

/// An argument, with the contents of the file that it names.
std::vector<std::string> with_contents(const std::vector<std::string>& arguments) {
  std::vector<std::string> key;
  for (const std::filesystem::path argument : arguments) {
    const bool is_file = std::filesystem::is_regular_file(argument);
    key.push_back(is_file ? argument.filename() : argument);
    if (is_file) key.push_back(contents(argument));
  }
  return key;
}

}  // namespace

Outcome run_shared(const std::vector<std::string>& arguments, const std::filesystem::path& out) {
  static const TemporaryFolder folder;
  struct Run {
    Outcome outcome;
    std::filesystem::path out;
  };
  static std::map<std::vector<std::string>, Run> runs;
  auto [run, is_new] = runs.try_emplace(with_contents(arguments));
  if (is_new) {
    run->second.out = folder / std::to_string(runs.size());
    std::vector<std::string> all = arguments;
    all.insert(all.end(), {"-o", run->second.out});
    run->second.outcome = run_sdm(all);
  }
  using Options = std::filesystem::copy_options;
  if (std::filesystem::exists(run->second.out))
    std::filesystem::copy(run->second.out, out, Options::recursive | Options::overwrite_existing);
  return run->second.outcome;
}

}  // namespace sdm::test
