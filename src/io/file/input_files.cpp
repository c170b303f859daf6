#include "io/file/input_files.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <system_error>
#include <utility>

namespace sdm::io {
namespace {

InputObserver& observer() {
  static InputObserver observer;
  return observer;
}

}  // namespace

void observe_inputs(InputObserver observer_of_process) {
  observer() = std::move(observer_of_process);
}

void note_input(const std::filesystem::path& file) {
  if (observer()) observer()(file);
}

void require_other_file(const std::filesystem::path& output, const std::filesystem::path& input) {
  std::error_code missing;
  if (std::filesystem::equivalent(output, input, missing))
    throw Error(fmt::format("cannot write {}: it is the input {}; choose another name", output.string(),
                            input.string()));
}

}  // namespace sdm::io
