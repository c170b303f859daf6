// --deflection: how closely the triangles of CAD files follow their surfaces.
#pragma once

#include <sdm/mesh.h>
#include <sdm/tolerance.h>

#include <CLI/CLI.hpp>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "report.h"
#include "src/io/mesh/placement.h"

/// Adds --deflection.
void add_deflection_option(CLI::App& app, sdm::TessellationOptions& options);

/// Throws CLI::ValidationError if a deflection was given but none of the inputs is CAD.
void check_deflection(const sdm::TessellationOptions& options, std::initializer_list<const Input*> inputs);
void check_deflection(const sdm::TessellationOptions& options, bool some_are_cad);

/// The deflection that a tolerance needs, in its unit: a tenth of half of the distance of the limits, or of
/// the only limit. Nothing without a finite limit other than 0.
[[nodiscard]] std::optional<double> deflection_for(const sdm::Tolerance& tolerance);
/// The least that some tolerances need.
[[nodiscard]] std::optional<double> deflection_for(const std::optional<sdm::Tolerance>& tolerance,
                                                   std::span<const sdm::GroupTolerance> rows);

/// The options for a file that is placed by these steps: their limit on the deflection is one on the mesh as
/// it is placed. What `fit` scales is not known before.
[[nodiscard]] sdm::TessellationOptions before_placement(sdm::TessellationOptions options,
                                                        const std::vector<sdm::io::PlacementStep>& steps);
/// How far a mesh that is placed by these steps, without `fit`, may be from its surface: 0 unless it is CAD.
[[nodiscard]] double placed_deviation(const std::optional<sdm::Tessellation>& tessellation,
                                      const std::vector<sdm::io::PlacementStep>& steps);

/// What `sdm info` prints: names and values.
[[nodiscard]] std::vector<std::pair<const char*, std::string>> rows_of(const sdm::Tessellation& tessellation);
