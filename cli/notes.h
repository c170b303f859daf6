// What suggests that the inputs of a command are not those, or not in the units, that the user meant: the
// lines `note` of every command's text, and the array `notes` of its JSON.
#pragma once

#include <sdm/mesh_edit.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "report.h"

using Notes = std::vector<std::string>;

/// The positions in a file are in single precision, and so far from the origin that neighbouring numbers are
/// more than 1e-5 of `size`, that of the mesh or cloud, apart.
[[nodiscard]] std::optional<std::string> note_on_precision(const std::string& file,
                                                           std::span<const sdm::Vec3> positions, double size);

/// A unit that is not known is only a label: nothing is converted, and a wrong one is not noticed.
[[nodiscard]] std::optional<std::string> note_on_unit(const std::string& units);

/// Notes on the files of both inputs.
[[nodiscard]] Notes file_notes(const Input& o1, const Input& o2);

/// Notes on the files of both inputs, and those of sdm::notes_on() on their boxes.
[[nodiscard]] Notes notes_on(const Input& o1, const Input& o2);

/// Notes on the files of bodies, on the largest of them and the others, and on bodies that are far from all
/// others. `poses`: one of each body.
[[nodiscard]] Notes notes_on(std::span<const Input> bodies, std::span<const sdm::Transform> poses);

/// One line each; the text begins in the given column.
[[nodiscard]] std::string note_lines(std::span<const std::string> notes, std::size_t column);
