// `sdm info MESH`: what a mesh is.
#pragma once

namespace CLI {
class App;
}

/// Adds the command to the application; it runs while the application parses.
void add_info_command(CLI::App& app);
