// The two meshes of a command.
#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "report.h"

/// The files of both and what is done to them, as they are given.
struct PairFiles {
  std::string o1, o2, transform_o1, transform_o2;
  std::optional<sdm::WeldOptions> weld{};
  sdm::TessellationOptions tessellation{};
};

/// Adds O1 and O2, both required, with these descriptions.
void add_pair_arguments(CLI::App& app, PairFiles& files, const std::array<std::string, 2>& descriptions);
/// Adds --transform-o1 and --transform-o2.
void add_pair_transforms(CLI::App& app, PairFiles& files);
/// Adds --weld and --deflection, which load_pair() follows.
void add_pair_reading(CLI::App& app, PairFiles& files);

/// Both meshes, after their transforms.
struct InputPair {
  Input o1, o2;
  double import_ms = 0;
};

struct PairReading {
  bool inspects = false;           ///< both meshes, as to_json(Input) needs it
  std::array<bool, 2> vertices{};  ///< keeps the vertices of each file
};

/// Reads both meshes at the same time. Throws sdm::Error.
[[nodiscard]] InputPair load_pair(const PairFiles& files, const PairReading& reading);

/// The diagonal of the smaller mesh, for the digits of places.
[[nodiscard]] double smaller_size(const InputPair& pair);

/// The first keys of a report on both meshes, which were inspected.
[[nodiscard]] nlohmann::ordered_json report_on(const InputPair& pair, const std::string& units);
