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
#include <cassert>  // IWYU pragma: keep, for __assert_fail()
#include <cstdlib>
#include <exception>
#include <initializer_list>
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

/// Ends the process where nothing can be caught, with a message of one line. Allocates nothing by itself.
[[noreturn]] void end_at_once(std::initializer_list<std::string_view> message) {
  static std::atomic_flag ending;
  while (ending.test_and_set()) pause();  // another thread ends it
  for (const std::string_view part : message)
    if (write(STDERR_FILENO, part.data(), part.size()) < 0) break;
  OutputFolder::discard_current();
  std::_Exit(kFailure);
}

/// After an exception of oneTBB while it creates a thread, of a destructor that allocates, as that of JSON
/// does, or before main().
[[noreturn]] void end_by_uncaught_exception() {
  end_at_once({"sdm: error: the system refused memory or a thread; allow more, or use --threads 1\n"});
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

#ifdef __GLIBC__
/// Replaces the C library's, so that unfinished files are removed: the JSON of Debian's TinyGLTF asserts that
/// it got memory.
// NOLINTNEXTLINE(bugprone-reserved-identifier)
extern "C" void __assert_fail(const char* assertion, const char*, unsigned, const char*) noexcept {
  end_at_once(
      {"sdm: error: a library found its state wrong, probably for lack of memory: ", assertion, "\n"});
}
#endif

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
