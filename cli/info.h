// `sdm info MESH`: counts, bounds and topology of a mesh.
#pragma once

namespace CLI {
class App;
}

/// Adds the command to the application; it runs while the application parses.
void add_info_command(CLI::App& app);
