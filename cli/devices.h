// `sdm devices`: lists the devices available to the gl and gpu engines.
#pragma once

namespace CLI {
class App;
}

/// Adds the command to the application; it runs while the application parses.
void add_devices_command(CLI::App& app);
