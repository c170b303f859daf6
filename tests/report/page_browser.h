// A browser for checks of pages.
#pragma once

#include <gtest/gtest.h>
#include <sys/types.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace sdm::test {

/// serve_checks.cjs in a process of its own, which is started by the first check, and again by the next one
/// where it has died. It ends with this object, and with the test program, however that ends.
class PageBrowser {
 public:
  /// Longer than a check waits for anything in a page.
  explicit PageBrowser(std::chrono::milliseconds patience = std::chrono::minutes(5)) : patience_(patience) {}
  ~PageBrowser() { end(); }
  PageBrowser(const PageBrowser&) = delete;
  PageBrowser& operator=(const PageBrowser&) = delete;

  /// The program and its arguments: `page` or `looks`, the check, the page, and what else the check needs. A
  /// check that does not end fails.
  [[nodiscard]] ::testing::AssertionResult check(const std::vector<std::string>& request);

 private:
  void start();
  void end();
  /// Nothing if there is none within `patience_`.
  [[nodiscard]] std::optional<std::string> answer_to(const std::string& line);

  std::chrono::milliseconds patience_;
  pid_t process_ = -1;
  int socket_ = -1;  // its stdin and stdout
};

/// Runs a check of check_page.cjs, in the browser of this program.
[[nodiscard]] ::testing::AssertionResult passes(const std::string& check, const std::string& page,
                                                const std::vector<std::string>& more = {});
/// One of check_looks.cjs.
[[nodiscard]] ::testing::AssertionResult looks(const std::string& check, const std::string& page,
                                               const std::vector<std::string>& more = {});

}  // namespace sdm::test
