// Checksums of files.
#pragma once

#include <filesystem>

#include "core/checksum.h"

namespace sdm::io {

/// Adds the bytes of a file. Throws sdm::Error if it cannot be read.
void add_file(core::Checksum& checksum, const std::filesystem::path& file);

}  // namespace sdm::io
