// `sdm devices`: lists the devices available to the gl and gpu engines.
#pragma once

namespace CLI {
class App;
}

/// Where there is no desktop, keeps Mesa's layer of Vulkan that asks the desktop for its device from printing
/// errors. Call it before the gpu engine is asked for anything, and while there is one thread.
void quiet_vulkan();

/// Adds the command to the application; it runs while the application parses.
void add_devices_command(CLI::App& app);
