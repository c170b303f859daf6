// What a mesh file has that was left out is said by every command that reads it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "support/run_sdm.h"
#include "support/temporary_folder.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kNote =
    "the texture coordinates are left out: in line 5, a face refers to number 9 of 0";

struct FileNotes : ::testing::Test {
  TemporaryFolder folder;
  std::string faulty = folder / "faulty.obj", good = folder / "good.obj", out = folder / "out";
  FileNotes() {
    const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n", rest = "f 1 2 4\nf 2 3 4\nf 1 4 3\n";
    std::ofstream(faulty) << vertices << "f 1/9 3/9 2/9\n" << rest;
    std::ofstream(good) << vertices << "f 1 3 2\n" << rest;
  }
};

TEST_F(FileNotes, ArePrintedByAllCommands) {
  const std::vector<std::vector<std::string>> commands = {
      {"map", faulty, good, "-o", out, "--resolution", "32", "--write", "none"},
      {"map", good, faulty, "-o", out, "--resolution", "32", "--write", "none"},
      {"proximity", good, faulty},
      {"hausdorff", good, faulty},
      {"bodies", good, faulty, faulty},
      {"self", faulty, "-o", out, "--resolution", "32", "--write", "none"},
      {"volume", faulty, "--grid", "4", "4", "4", "-o", folder / "field.npy"},
      {"info", faulty}};
  for (const auto& command : commands) {
    const Outcome text = run_sdm(command);
    EXPECT_EQ(text.code, 0) << command[0] << text.err;
    EXPECT_THAT(text.out, HasSubstr(kNote)) << command[0];
    EXPECT_EQ(text.out.find(kNote), text.out.rfind(kNote)) << command[0] << ": once";
    auto with_json = command;
    with_json.emplace_back("--json");
    const Outcome json = run_sdm(with_json);
    EXPECT_TRUE(nlohmann::json::accept(json.out)) << json.out;
    EXPECT_THAT(json.out, HasSubstr(kNote)) << command[0];
    auto quiet = command;
    quiet.emplace_back("--quiet");
    if (command[0] != "info") {
      EXPECT_EQ(run_sdm(quiet).out, "") << command[0];
    }
  }
}

TEST_F(FileNotes, NameTheirFileInReports) {
  ASSERT_EQ(run_sdm({"map", good, faulty, "-o", out, "--resolution", "32", "--write", "none"}).code, 0);
  const auto report = nlohmann::json::parse(std::ifstream(out + "/report.json"));
  EXPECT_EQ(report["notes"], nlohmann::json::array({faulty + ": " + kNote}));
  EXPECT_THAT(run_sdm({"info", good}).out, Not(HasSubstr("note")));
}

}  // namespace
}  // namespace sdm::test
