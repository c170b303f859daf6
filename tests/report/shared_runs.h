// Runs of the command whose files several cases need.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "support/run_sdm.h"

namespace sdm::test {

/// Runs the command with `-o out`, or copies to there what it wrote for the same arguments and contents of
/// files before.
[[nodiscard]] Outcome run_shared(const std::vector<std::string>& arguments, const std::filesystem::path& out);

}  // namespace sdm::test
