// --weld: boundary edges of the meshes that coincide but for rounding are joined.
#pragma once

#include <sdm/mesh_edit.h>

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "report.h"

/// Adds --weld; `meshes` that it applies to, in the help text.
void add_weld_option(CLI::App& app, std::optional<sdm::WeldOptions>& weld, const std::string& meshes);

/// Welds the mesh of an input, which was not inspected, and notes what was done.
void weld(Input& input, const sdm::WeldOptions& options);

/// A note on distances that have no sign although one was wanted, if the mesh would be closed with `--weld
/// auto`. Cost: that of sdm::weld().
[[nodiscard]] std::optional<std::string> note_on_welding(const sdm::SignUsed& used, sdm::SignMethod wanted,
                                                         const Input& to);

/// Throws sdm::Error, which names what would close it, if the mesh is open. `what` needs a closed one.
void check_closed(const Input& input, const std::string& what);

/// Throws sdm::Error if the tolerance needs signs, but distances to the mesh have none.
void check_sign(const std::optional<sdm::Tolerance>& tolerance, const sdm::SignUsed& sign, const Input& to);
