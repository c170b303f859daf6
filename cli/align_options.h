// The options of --align: where an alignment starts, what it may move, and what it is fitted to.
#pragma once

#include <sdm/align.h>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "report.h"

struct AlignCommand {
  bool on = false;
  std::string from = "auto";        ///< "auto", "none", "pca" or the name of a matrix file
  std::string points_321{};         ///< the file of --align-321; or empty
  sdm::AlignFreedoms freedoms{};    ///< of --align-free and --align-about
  std::vector<std::string> region;  ///< of --align-on
  bool judged = false;  ///< a verdict depends on it: whether O1 fits in another unit is looked at too
};

/// Adds --align, and the options that begin with it.
void add_align_options(CLI::App& app, AlignCommand& command);

/// The groups, objects or materials and the boxes of --align-on. Throws sdm::Error for a name that O2 does
/// not have.
[[nodiscard]] sdm::AlignRegion region_of(const AlignCommand& command, const Input& o2);

/// The motion of a file of --align-321: six rows of a point on O1 and its place on O2. Throws sdm::Error.
[[nodiscard]] sdm::Transform read_321(const std::string& file);
