// What every reader guarantees for any bytes.
#pragma once

#include <filesystem>

namespace sdm::test {

/// Reads a mesh or sequence, all frames; of the extensions xyz, csv, pts, ptx, pcd, las and cloud, a point
/// cloud; of the extension matrix, a matrix. Returns whether it was read; if not, it was refused with an
/// sdm::Error in one line. Throws std::logic_error if the result is not valid, or the error not of one line.
bool try_read(const std::filesystem::path& file);

}  // namespace sdm::test
