#include "support/run_sdm.h"

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace sdm::test {
namespace {

void set_limit(__rlimit_resource resource, std::optional<std::uint64_t> value) {
  if (!value) return;
  const rlimit limit{*value, *value};
  setrlimit(resource, &limit);
}

/// The processor time, in seconds, that a child has used so far.
double cpu_time(pid_t child) {
  std::ifstream file("/proc/" + std::to_string(child) + "/stat");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  std::istringstream fields(text.substr(std::min(text.size(), text.rfind(')') + 1)));
  std::string skipped;
  for (int i = 3; i < 14; ++i) fields >> skipped;
  double user = 0, system = 0;
  fields >> user >> system;
  return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

/// Reads both ends until they are closed. Calls `read_some` after each part.
void drain(std::array<int, 2> ends, std::array<std::string*, 2> texts,
           const std::function<void()>& read_some) {
  for (int open = 2; open > 0;) {
    std::array<pollfd, 2> polls{{{ends[0], POLLIN, 0}, {ends[1], POLLIN, 0}}};
    poll(polls.data(), polls.size(), -1);
    for (std::size_t i = 0; i < 2; ++i) {
      if (polls[i].revents == 0) continue;
      std::array<char, 4096> buffer;
      const ssize_t count = read(ends[i], buffer.data(), buffer.size());
      if (count > 0) {
        texts[i]->append(buffer.data(), static_cast<std::size_t>(count));
        read_some();
      } else {
        close(ends[i]);
        ends[i] = -1;  // poll skips it
        --open;
      }
    }
  }
}

}  // namespace

Outcome run_program(const char* program, const std::vector<std::string>& arguments,
                    const Conditions& options) {
  std::vector<char*> argv{const_cast<char*>(program)};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);

  std::array<int, 2> out, err;
  const winsize window{.ws_row = 24, .ws_col = options.columns, .ws_xpixel = 0, .ws_ypixel = 0};
  const bool made =
      (options.columns > 0 ? openpty(&out[0], &out[1], nullptr, nullptr, &window) : pipe(out.data())) == 0 &&
      (options.terminal ? openpty(&err[0], &err[1], nullptr, nullptr, nullptr) : pipe(err.data())) == 0;
  if (!made) throw std::runtime_error("no pipe");
  // A small pipe blocks a command that runs ahead, so that it cannot end before the signal is sent however
  // late this process gets its turn.
  if (options.interrupt_after_lines > 0 && fcntl(out[1], F_SETPIPE_SZ, 4096) < 0)
    throw std::runtime_error("no small pipe");
  const pid_t child = fork();
  if (child == 0) {
    dup2(out[1], STDOUT_FILENO);
    dup2(err[1], STDERR_FILENO);
    for (const int end : {out[0], out[1], err[0], err[1]}) close(end);
    // Shells and nohup ignore some of them in what they start.
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_DFL);
    if (options.file_size) std::signal(SIGXFSZ, SIG_IGN);
    set_limit(RLIMIT_FSIZE, options.file_size);
    set_limit(RLIMIT_AS, options.memory);
    set_limit(RLIMIT_STACK, options.stack);
    for (const std::string& variable : options.environment) putenv(const_cast<char*>(variable.c_str()));
    execv(program, argv.data());
    _exit(127);
  }
  close(out[1]);
  close(err[1]);

  std::thread interrupter;
  std::optional<double> cpu_at_signal;
  const auto interrupt = [&](int signal) {
    cpu_at_signal = cpu_time(child);
    kill(child, signal);
  };
  const bool to_kill = options.kill_after_ms > 0;
  if (const int ms = to_kill ? options.kill_after_ms : options.interrupt_after_ms; ms > 0)
    interrupter = std::thread([=, &options, &interrupt] {
      std::this_thread::sleep_for(std::chrono::milliseconds(ms));
      interrupt(to_kill ? SIGKILL : options.signal);
    });
  Outcome run;
  bool sent = options.interrupt_after_lines == 0;
  drain({out[0], err[0]}, {&run.out, &run.err}, [&] {
    if (sent || std::ranges::count(run.out, '\n') < options.interrupt_after_lines) return;
    sent = true;
    interrupt(options.signal);
  });
  if (interrupter.joinable()) interrupter.join();
  int status = 0;
  rusage used{};
  wait4(child, &status, 0, &used);
  if (cpu_at_signal) run.cpu_after_signal = seconds(used.ru_utime) + seconds(used.ru_stime) - *cpu_at_signal;
  run.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return run;
}

Outcome run_sdm(const std::vector<std::string>& arguments, const Conditions& options) {
  const char* const other = std::getenv("SDM_TESTED_COMMAND");  // sanitizer_options.cpp
  return run_program(other != nullptr ? other : SDM_COMMAND, arguments, options);
}

}  // namespace sdm::test
