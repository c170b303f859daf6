#include "samples.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

int main(int argc, char** argv) try {
  CLI::App program("Meshes, samples and times of sdm for bench/peers, bench/python and bench/whole");
  program.require_subcommand(1);
  sdm::bench::add_align(program);
  sdm::bench::add_calls(program);
  sdm::bench::add_hausdorff(program);
  sdm::bench::add_map(program);
  sdm::bench::add_poses(program);
  sdm::bench::add_refine(program);
  CLI11_PARSE(program, argc, argv);
} catch (const std::exception& error) {
  std::fprintf(stderr, "samples: %s\n", error.what());
  return 1;
}
