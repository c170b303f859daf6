// The sdm command.
#include "command_line.h"
#include "exit_codes.h"
#include "freed_memory.h"
#include "interrupts.h"
#include "output_folder.h"
#include "read_files.h"
#include "terminal_text.h"

#include <sdm/error.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <string_view>

namespace {

/// The option that remedies the error, as text for its message.
const char* advice(sdm::Remedy remedy) {
  switch (remedy) {
    case sdm::Remedy::none:
      break;
    case sdm::Remedy::atlas_kind:
      return " (--atlas charts)";
    case sdm::Remedy::resolution:
      return " (--resolution)";
    case sdm::Remedy::sign_method:
      return " (--sign)";
  }
  return "";
}

/// Ends the process after an exception that cannot be caught: of oneTBB while it creates a thread, of a
/// destructor that allocates, as that of JSON does, or before main(). Allocates nothing by itself.
[[noreturn]] void end_by_uncaught_exception() {
  static std::atomic_flag ending;
  while (ending.test_and_set()) pause();  // another thread ends it
  constexpr std::string_view kMessage =
      "sdm: error: the system refused memory or a thread; allow more, or use --threads 1\n";
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, kMessage.data(), kMessage.size());
  OutputFolder::discard_current();
  std::_Exit(kFailure);
}

#ifdef __linux__
/// Before the static objects of this program and of the libraries that it loads, which allocate.
extern "C" void prepare_for_uncaught_exceptions() {
  std::set_terminate(end_by_uncaught_exception);
}
[[gnu::section(".preinit_array"), gnu::used]] void (*const kPrepare)() = prepare_for_uncaught_exceptions;
#endif

/// What the exception that is being handled says.
std::string message_of_failure() {
  try {
    throw;
  } catch (const sdm::Cancelled& error) {
    return error.what();
  } catch (const sdm::Error& error) {
    return printable_lines(error.what()) + advice(error.remedy());
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    return printable_lines(error.what());
  }
}

/// Prints it as one line, whatever memory there is.
void print_failure() {
  try {
    const std::string message = message_of_failure();
    std::cerr << "sdm: error: " << message << '\n';
  } catch (const std::bad_alloc&) {
    std::cerr << "sdm: error: not enough memory; choose a lower --resolution or smaller meshes\n";
  }
}

}  // namespace

int main(int argc, char** argv) {
  keep_freed_memory();
  std::set_terminate(end_by_uncaught_exception);
  const Interrupts interrupts;
  try {
    watch_inputs({argv, static_cast<std::size_t>(argc)});
    const PrintableOutput output;
    return run_command_line(argc, argv);
  } catch (const std::exception&) {
    print_failure();
  }
  Interrupts::end();
  return kFailure;
}
