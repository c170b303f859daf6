// Who wants to know which files are read.
#pragma once

#include <filesystem>
#include <functional>

namespace sdm::io {

/// Is called with each file that is about to be read, also those that a model refers to, from any thread.
/// What it throws ends the reading.
using InputObserver = std::function<void(const std::filesystem::path&)>;

/// Sets the observer of this process. Not while another thread reads.
void observe_inputs(InputObserver observer);

/// Remembers a file as an input. Called wherever a file that users have named, or to which such a file
/// refers, is opened.
void note_input(const std::filesystem::path& file);

/// Throws sdm::Error if both are one file, by whatever names: writing `output` would destroy `input`.
void require_other_file(const std::filesystem::path& output, const std::filesystem::path& input);

}  // namespace sdm::io
