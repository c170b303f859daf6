// Runs the program sdm-paper in a process of its own.
#pragma once

#include "support/run_sdm.h"

namespace sdm::test {

inline Outcome run_sdm_paper(const std::vector<std::string>& arguments, const Conditions& options = {}) {
  return run_program(SDM_PAPER_PROGRAM, arguments, options);
}

}  // namespace sdm::test
