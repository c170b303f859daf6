// The browser that checks share.
#include "report/page_browser.h"

#include <gtest/gtest.h>

#include <fstream>

#include "support/temporary_folder.h"

namespace sdm::test {
namespace {

TEST(PageBrowser, GoesOnAfterAFault) {
  const TemporaryFolder folder;
  const std::string page = folder / "page.html";
  std::ofstream(page) << "<!DOCTYPE html><html data-ready><title>Words</title>"
                         "<link rel=icon href=data:,><canvas id=canvas></canvas>\n\"words\"\n";
  PageBrowser browser;
  EXPECT_TRUE(browser.check({"page", "says", page, "\"words\""}));
  const auto fault = browser.check({"page", "says", page, "others"});
  EXPECT_FALSE(fault);
  EXPECT_NE(std::string(fault.message()).find("no \"others\" in: "), std::string::npos) << fault.message();
  // What a page logs is a fault of its check alone.
  std::ofstream(page, std::ios::app) << "<script>console.log('noise')</script>";
  EXPECT_NE(std::string(browser.check({"page", "says", page}).message()).find("console: noise"),
            std::string::npos);
}

TEST(PageBrowser, GoesOnAfterACheckThatDoesNotEnd) {
  const TemporaryFolder folder;
  const std::string page = folder / "never.html";
  std::ofstream(page) << "<!DOCTYPE html><title>Never ready</title>";
  PageBrowser impatient(std::chrono::seconds(2));
  for (int i = 0; i < 2; ++i) {
    const auto fault = impatient.check({"page", "says", page});
    EXPECT_FALSE(fault);
    EXPECT_NE(std::string(fault.message()).find("no answer"), std::string::npos) << fault.message();
  }
}

}  // namespace
}  // namespace sdm::test
