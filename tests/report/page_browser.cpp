#include "report/page_browser.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>

namespace sdm::test {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kEnd{10};  // for the browser to close

/// Reads some bytes; none if there are none until then, or the other end is closed.
std::string read_some(int socket, Clock::time_point until) {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now());
  pollfd end{socket, POLLIN, 0};
  if (poll(&end, 1, static_cast<int>(std::max<std::int64_t>(0, left.count()))) <= 0) return {};
  std::array<char, 4096> bytes;
  const ssize_t count = read(socket, bytes.data(), bytes.size());
  return {bytes.data(), static_cast<std::size_t>(std::max<ssize_t>(0, count))};
}

::testing::AssertionResult checked(const char* program, const std::string& check, const std::string& page,
                                   const std::vector<std::string>& more) {
  static PageBrowser browser;
  std::vector<std::string> request{program, check, page};
  request.insert(request.end(), more.begin(), more.end());
  return browser.check(request);
}

}  // namespace

void PageBrowser::start() {
  std::array<int, 2> ends;
  // Not for the commands that a test starts, which would keep it open.
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    throw std::runtime_error("no socket for the browser");
  process_ = fork();
  if (process_ == 0) {
    dup2(ends[1], STDIN_FILENO);
    dup2(ends[1], STDOUT_FILENO);
    if (chdir(SDM_REPORT_PACKAGES) == 0) execlp("node", "node", SDM_SERVE_CHECKS, nullptr);
    _exit(127);
  }
  close(ends[1]);
  socket_ = ends[0];
}

void PageBrowser::end() {
  if (process_ <= 0) return;
  shutdown(socket_, SHUT_WR);
  const auto until = Clock::now() + kEnd;
  while (!read_some(socket_, until).empty()) continue;
  kill(process_, SIGKILL);  // if it has not ended; its browser ends with it
  waitpid(process_, nullptr, 0);
  close(socket_);
  process_ = -1;
  socket_ = -1;
}

std::optional<std::string> PageBrowser::answer_to(const std::string& line) {
  const auto until = Clock::now() + patience_;
  for (std::string_view left = line; !left.empty();) {
    const ssize_t sent = send(socket_, left.data(), left.size(), MSG_NOSIGNAL);
    if (sent < 0) return {};
    left.remove_prefix(static_cast<std::size_t>(sent));
  }
  std::string answer;
  while (!answer.ends_with('\n')) {
    const std::string more = read_some(socket_, until);
    if (more.empty()) return {};
    answer += more;
  }
  return answer;
}

::testing::AssertionResult PageBrowser::check(const std::vector<std::string>& request) {
  // One that has nothing to do says nothing: it has died.
  pollfd idle{socket_, POLLIN, 0};
  if (process_ > 0 && poll(&idle, 1, 0) != 0) end();
  if (process_ <= 0) start();
  const auto begin = Clock::now();
  const auto answer = answer_to(nlohmann::json(request).dump() + '\n');
  if (!answer) {
    end();
    const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    return ::testing::AssertionFailure() << fmt::format("{} {} {}: no answer, after {:.0f} s", request.at(0),
                                                        request.at(1), request.at(2), seconds);
  }
  const auto fault = nlohmann::json::parse(*answer);
  if (fault.is_null()) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure()
         << request.at(1) << " of " << request.at(2) << ": " << fault.get<std::string>();
}

::testing::AssertionResult passes(const std::string& check, const std::string& page,
                                  const std::vector<std::string>& more) {
  return checked("page", check, page, more);
}

::testing::AssertionResult looks(const std::string& check, const std::string& page,
                                 const std::vector<std::string>& more) {
  return checked("looks", check, page, more);
}

}  // namespace sdm::test
