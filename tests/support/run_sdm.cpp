#include "support/run_sdm.h"

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
#include <functional>
#include <stdexcept>
#include <thread>

namespace sdm::test {
namespace {

void set_limit(__rlimit_resource resource, std::optional<std::uint64_t> value) {
  if (!value) return;
  const rlimit limit{*value, *value};
  setrlimit(resource, &limit);
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

Outcome run_sdm(const std::vector<std::string>& arguments, const Conditions& options) {
  std::vector<char*> argv{const_cast<char*>("sdm")};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);

  std::array<int, 2> out, err;
  const bool made =
      pipe(out.data()) == 0 &&
      (options.terminal ? openpty(&err[0], &err[1], nullptr, nullptr, nullptr) : pipe(err.data())) == 0;
  if (!made) throw std::runtime_error("no pipe");
  const pid_t child = fork();
  if (child == 0) {
    dup2(out[1], STDOUT_FILENO);
    dup2(err[1], STDERR_FILENO);
    for (const int end : {out[0], out[1], err[0], err[1]}) close(end);
    if (options.file_size) std::signal(SIGXFSZ, SIG_IGN);
    set_limit(RLIMIT_FSIZE, options.file_size);
    set_limit(RLIMIT_AS, options.memory);
    for (const std::string& variable : options.environment) putenv(const_cast<char*>(variable.c_str()));
    execv(SDM_COMMAND, argv.data());
    _exit(127);
  }
  close(out[1]);
  close(err[1]);

  std::thread interrupter;
  const bool to_kill = options.kill_after_ms > 0;
  if (const int ms = to_kill ? options.kill_after_ms : options.interrupt_after_ms; ms > 0)
    interrupter = std::thread([=, &options] {
      std::this_thread::sleep_for(std::chrono::milliseconds(ms));
      kill(child, to_kill ? SIGKILL : options.signal);
    });
  Outcome run;
  bool sent = options.interrupt_after_lines == 0;
  drain({out[0], err[0]}, {&run.out, &run.err}, [&] {
    if (sent || std::ranges::count(run.out, '\n') < options.interrupt_after_lines) return;
    sent = true;
    kill(child, options.signal);
  });
  if (interrupter.joinable()) interrupter.join();
  int status = 0;
  waitpid(child, &status, 0);
  run.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return run;
}

}  // namespace sdm::test
