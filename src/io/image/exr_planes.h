// OpenEXR files of planes of 32-bit numbers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace sdm::io {

/// A channel of a file.
struct ExrPlane {
  std::string name;
  bool whole = false;  ///< UINT; otherwise FLOAT
};

/// What a file says of itself: the comment `title`, with the version of sdm, and string attributes.
struct ExrText {
  std::string title;
  std::vector<std::pair<std::string, std::string>> attributes;
};

/// Sets the bits of the numbers of row y, one plane after another. Called from several threads.
using ReadRow = std::function<void(std::uint32_t y, std::span<std::uint32_t> row)>;

/// Writes a file. `planes`: in the order of their names, as files store them. Throws sdm::Error if it cannot
/// be written. Cost: linear, all cores; memory for some rows.
void write_planes(const std::filesystem::path& file, std::uint32_t columns, std::uint32_t rows,
                  std::span<const ExrPlane> planes, const ExrText& text, const ReadRow& read);

}  // namespace sdm::io
