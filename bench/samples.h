// What bench/samples writes and times for other programs: a subcommand each. Arrays are written without
// headers.
#pragma once

namespace CLI {
class App;
}

namespace sdm::bench {

void add_align(CLI::App& program);
void add_calls(CLI::App& program);
void add_hausdorff(CLI::App& program);
void add_map(CLI::App& program);
void add_poses(CLI::App& program);
void add_refine(CLI::App& program);

}  // namespace sdm::bench
