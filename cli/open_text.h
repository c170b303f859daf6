// Files of numbers that options name.
#pragma once

#include <filesystem>
#include <fstream>

/// Opens a regular file: reading a pipe would wait, and a device may never end. Throws sdm::Error, naming it.
[[nodiscard]] std::ifstream open_text(const std::filesystem::path& file);
