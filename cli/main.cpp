// The sdm command.
#include "command_line.h"
#include "exit_codes.h"
#include "freed_memory.h"
#include "interrupts.h"
#include "output_folder.h"
#include "read_files.h"
#include "terminal_text.h"

#include <sdm/error.h>

#include <cstdlib>
#include <exception>
#include <iostream>
#include <new>

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

/// Ends the process after an exception that cannot be caught: oneTBB throws one while it creates a thread.
[[noreturn]] void end_by_uncaught_exception() {
  std::cerr << "sdm: error: the system refused memory or a thread; allow more, or use --threads 1\n";
  OutputFolder::discard_current();
  std::_Exit(1);
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
  } catch (const sdm::Cancelled& error) {
    std::cerr << "sdm: error: " << error.what() << '\n';
  } catch (const std::bad_alloc&) {
    std::cerr << "sdm: error: not enough memory; choose a lower --resolution or smaller meshes\n";
  } catch (const sdm::Error& error) {
    std::cerr << "sdm: error: " << printable_lines(error.what()) << advice(error.remedy()) << '\n';
  } catch (const std::exception& error) {
    std::cerr << "sdm: error: " << printable_lines(error.what()) << '\n';
  }
  Interrupts::end();
  return kFailure;
}
