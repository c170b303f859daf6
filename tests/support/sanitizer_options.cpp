// How programs with sanitizers run, and what their tests run: defaults that the environment can change.
#include <cstdlib>

// GCC before 14 misreads the thread-local storage of loaded libraries such as OpenGL's, and the leak checker
// then crashes now and then: it does without.
extern "C" const char* __asan_default_options() {
  return "intercept_tls_get_addr=0";
}
extern "C" const char* __lsan_default_options() {
  return "print_suppressions=0";
}
// Caches that fontconfig keeps to the end of the process.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libfontconfig\n";
}

namespace {

// The command that tests run, and the random scenes of which each takes ten times as long.
[[maybe_unused]] const int command = setenv("SDM_TESTED_COMMAND", SDM_SANITIZED_COMMAND, 0);
[[maybe_unused]] const int scenes = setenv("SDM_SCENES", "100", 0);

}  // namespace
