#include "interrupts.h"

#include <pthread.h>
#include <semaphore.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>  // IWYU pragma: keep, for its literals
#include <csignal>
#include <ctime>
#include <string_view>
#include <thread>

#include "output_folder.h"

namespace {

using namespace std::chrono_literals;

constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};
// Work that has not stopped after the patience is given up if it waits for something, and after the longest
// one if it computes: it may be about to poll on a machine with much else to do.
constexpr auto kPatience = 500ms, kLongestPatience = 3000ms;
constexpr double kIdle = 0.005;  // seconds of processor time within the patience: a thread that waits
std::atomic<bool> cancelled{false};
const std::atomic<bool> never{false};
std::atomic<int> interrupted_by{0};
sem_t arrived;
// The number of Protected objects, or kEnding once the program ends.
constexpr int kEnding = -1;
std::atomic<int> protections{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free,
              "a signal handler writes them");

extern "C" void interrupt(int signal) {
  interrupted_by = signal;
  cancelled = true;
  std::signal(signal, SIG_DFL);
  sem_post(&arrived);
}

double processor_seconds() {
  timespec used{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
  return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
}

extern "C" void* watch(void*) {
  while (sem_wait(&arrived) != 0) {
  }
  for (auto waited = 0ms; waited < kLongestPatience; waited += kPatience) {
    const double before = processor_seconds();
    std::this_thread::sleep_for(kPatience);
    if (processor_seconds() - before < kIdle) break;
  }
  for (int none = 0; !protections.compare_exchange_strong(none, kEnding); none = 0)
    std::this_thread::sleep_for(10ms);
  OutputFolder::discard_current();
  constexpr std::string_view kMessage = "sdm: error: cancelled\n";
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, kMessage.data(), kMessage.size());
  Interrupts::end();
  return nullptr;
}

// A small stack of its own, so that little memory suffices. Without the thread, polling remains.
void start_watching() {
  constexpr std::size_t kStack = 256 << 10;
  sigset_t all, before;
  sigfillset(&all);
  pthread_attr_t attributes;
  if (sem_init(&arrived, 0, 0) != 0 || pthread_attr_init(&attributes) != 0) return;
  pthread_attr_setstacksize(&attributes, kStack);
  pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
  pthread_sigmask(SIG_SETMASK, &all, &before);  // the watcher inherits the mask
  pthread_t watcher;
  pthread_create(&watcher, &attributes, watch, nullptr);
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  pthread_attr_destroy(&attributes);
}

}  // namespace

Interrupts::Interrupts() : scope_(cancelled) {
  start_watching();
  for (const int signal : kSignals)
    if (std::signal(signal, interrupt) == SIG_IGN) std::signal(signal, SIG_IGN);
}

Interrupts::~Interrupts() {
  for (const int signal : kSignals)
    if (std::signal(signal, SIG_DFL) == SIG_IGN) std::signal(signal, SIG_IGN);
}

bool Interrupts::received() {
  return cancelled;
}

void Interrupts::end() {
  if (interrupted_by == 0) return;
  sigset_t signal;
  sigemptyset(&signal);
  sigaddset(&signal, interrupted_by);
  pthread_sigmask(SIG_UNBLOCK, &signal, nullptr);
  std::signal(interrupted_by, SIG_DFL);
  std::raise(interrupted_by);
}

Interrupts::Protected::Protected() : scope_(never) {
  for (int count = protections; !protections.compare_exchange_weak(count, count + 1);)
    while (count == kEnding) pause();  // the watcher ends the program
}

Interrupts::Protected::~Protected() {
  --protections;
}
