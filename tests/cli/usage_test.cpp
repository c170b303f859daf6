#include "support/run_sdm.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/version.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "cli/samples.h"
#include "support/matches.h"
#include "support/temporary_folder.h"

namespace sdm::test {
namespace {

using ::testing::HasSubstr;

TEST(Usage, NoArgumentsShowTheHelp) {
  const Outcome run = run_sdm({});
  EXPECT_EQ(run.code, 0);
  EXPECT_THAT(run.out, HasSubstr("sdm map"));
  EXPECT_EQ(run.err, "");
}

TEST(Usage, HelpAndVersionAreNoErrors) {
  EXPECT_EQ(run_sdm({"--version"}).out, std::string("sdm ") + kVersion + "\n");
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"--help"}, {"map", "--help"}, {"info", "--help"}, {"--version"}}) {
    const Outcome run = run_sdm(arguments);
    EXPECT_EQ(run.code, 0);
    EXPECT_EQ(run.err, "");
  }
  EXPECT_THAT(run_sdm({"map", "--help"}).out, HasSubstr("Example"));
}

// Lines longer than the terminal hold a single word, or an example that can be copied.
TEST(Usage, HelpFitsTheTerminal) {
  for (const std::size_t width : {40, 61, 100})
    for (const char* command : {"map", "sequence", "bodies"}) {
      const Outcome run = run_sdm({command, "--help"}, {.environment = {"COLUMNS=" + std::to_string(width)}});
      std::istringstream lines(run.out);
      std::size_t longest = 0;
      for (std::string line; std::getline(lines, line);) {
        const auto characters = static_cast<std::size_t>(std::ranges::count_if(
            line, [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
        const bool breakable = line.find(' ', line.find_first_not_of(' ')) != std::string::npos;
        if (breakable && !line.starts_with("  sdm ")) {
          EXPECT_LE(characters, width) << line;
          longest = std::max(longest, characters);
        }
      }
      EXPECT_GT(longest, width - 15) << "lines are filled";
    }
  // The words are those of the help on a wide terminal.
  const auto words = [](const std::string& columns) {
    std::istringstream text(run_sdm({"map", "--help"}, {.environment = {"COLUMNS=" + columns}}).out);
    return std::vector<std::string>(std::istream_iterator<std::string>(text), {});
  };
  EXPECT_EQ(words("40"), words("120"));
}

TEST(Usage, CompletionsAndTheManualNameAllOptions) {
  const TemporaryFolder folder;
  const std::string help = run_sdm({"map", "--help"}).out, manual = run_sdm({"help", "--man"}).out;
  std::vector<std::string> options;
  for (std::size_t at = 0; (at = help.find("--", at)) != std::string::npos; ++at)
    options.push_back(help.substr(at + 2, help.find_first_of(" =\n", at) - at - 2));
  ASSERT_GT(options.size(), 25u);
  for (const char* shell : {"bash", "zsh", "fish"}) {
    const Outcome run = run_sdm({"completion", shell});
    EXPECT_EQ(run.code, 0) << run.err;
    for (const std::string& option : options) EXPECT_THAT(run.out, HasSubstr(option)) << shell;
    for (const char* word : {"sequence", "triangles"}) EXPECT_THAT(run.out, HasSubstr(word)) << shell;
    EXPECT_EQ(run.out.find("completion "), run.out.find("completion for sdm"))
        << "it is not a command for users";
    if (std::string(shell) == "bash") {
      std::ofstream(folder / "sdm.bash") << run.out;
      const std::string check =
          "bash -c 'set -e; source \"$0\"; COMP_WORDS=(sdm map --atlas c); COMP_CWORD=3; _sdm; "
          "[ \"${COMPREPLY[*]}\" = charts ]' ";
      EXPECT_EQ(std::system((check + std::string(folder / "sdm.bash")).c_str()), 0);
    }
  }
  for (std::string option : options) {
    for (std::size_t at = 0; (at = option.find('-', at)) != std::string::npos; at += 2)
      option.replace(at, 1, "\\-");
    EXPECT_THAT(manual, HasSubstr(option));
  }
  EXPECT_TRUE(manual.starts_with(".TH SDM 1 "));
  EXPECT_EQ(run_sdm({"completion", "tcsh"}).code, 2);
}

// A declared option has the default and the words of the command that it is an option of.
TEST(Usage, HelpStatesTheDefaultsOfTheCommand) {
  const auto help = [](const char* command) {
    return run_sdm({command, "--help"}, {.environment = {"COLUMNS=120"}}).out;
  };
  EXPECT_THAT(help("map"), HasSubstr("--resolution N|WxH=1024"));
  EXPECT_THAT(help("sequence"), HasSubstr("--resolution N|WxH=512"));
  EXPECT_THAT(help("bodies"), HasSubstr("--resolution N=128"));
  EXPECT_THAT(help("bake"), HasSubstr("farther than this from HIGH have no match"));
}

// The options of a command that are whole numbers, and how many of them each takes.
std::map<std::string, std::size_t> whole_number_options(const std::string& command) {
  const std::string help = run_sdm({command, "--help"}, {.environment = {"COLUMNS=200"}}).out;
  std::map<std::string, std::size_t> options;
  for (const Match& match : matches(help, "(--[a-z0-9-]+) (N|NX NY NZ)([^A-Za-z]|$)"))
    options[match.groups[0]] = match.groups[1] == "N" ? 1 : 3;
  return options;
}

std::vector<std::string> command_names() {
  const std::string help = run_sdm({"--help"}, {.environment = {"COLUMNS=200"}}).out;
  std::vector<std::string> names;
  for (const Match& match : matches(help, "^  ([a-z]+)  +[A-Z]")) names.push_back(match.groups[0]);
  return names;
}

// 9 is no digit of base 8, and 0x is no prefix.
TEST(Usage, AllWholeNumbersAreReadInBaseTen) {
  std::size_t count = 0;
  for (const std::string& command : command_names())
    for (const auto& [option, values] : whole_number_options(command)) {
      ++count;
      const auto is_refused = [&](const std::string& value) {
        std::vector<std::string> arguments{command, option};
        arguments.insert(arguments.end(), values, value);
        const Outcome run = run_sdm(arguments);
        EXPECT_EQ(run.code, 2) << command << ' ' << option;  // at least what is required is missing
        return run.err.find(value + " is ") != std::string::npos ||
               run.err.find(option + " is " + value + ":") != std::string::npos;
      };
      // 9 or 99 may be below the least value, 999 above the greatest.
      EXPECT_FALSE(is_refused("09") && is_refused("099") && is_refused("0999")) << command << ' ' << option;
      for (const char* value : {"0x40", "1e2", "6_4"})
        EXPECT_TRUE(is_refused(value)) << command << ' ' << option << ' ' << value;
    }
  EXPECT_GT(count, 20u);
}

TEST(Usage, LeadingZerosDoNotChangeANumber) {
  const TemporaryFolder folder;
  const std::string mesh = folder / "a.off";
  std::ofstream(mesh) << "OFF 4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
  for (const char* resolution : {"0100", "100", "+100"}) {
    const Outcome run = run_sdm({"map", mesh, mesh, "-o", folder / "out", "--json", "--write", "none",
                                 "--resolution", resolution, "--gutter", "010", "--max-distance", "010"});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("\"resolution\": 100,")) << resolution;
    EXPECT_THAT(run.out, HasSubstr("\"gutter\": 10,")) << resolution;
    EXPECT_THAT(run.out, HasSubstr("\"max_distance\": 10.0")) << resolution;
  }
  EXPECT_EQ(run_sdm({"map", mesh, mesh, "-o", folder / "out", "--atlas", "uv", "--resolution", "0x40"}).code,
            2);
  EXPECT_EQ(run_sdm({"map", mesh, mesh, "-o", folder / "out", "--max-distance", "0x10"}).code, 2);
}

// Each is refused before any file is looked at, with a message that names the part at fault.
TEST(Usage, WrongUsageEndsWithTwo) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  const std::vector<std::string> start{"map", "a.obj", "b.obj", "-o", out};
  const std::vector<std::vector<std::string>> wrong_tails{{"--resolution", "15"},
                                                          {"--resolution", "32769"},
                                                          {"--resolution", "many"},
                                                          {"--resolution", "1e3"},
                                                          {"--resolution", "-64"},
                                                          {"--resolution"},
                                                          {"--precision", "0"},
                                                          {"--precision", "fine"},
                                                          {"--precision", "0.1", "--resolution", "64"},
                                                          {"--atlas", "chart"},
                                                          {"--atlas", "0"},
                                                          {"--sign", "maybe"},
                                                          {"--engine", "cuda"},
                                                          {"--colormap", "jet"},
                                                          {"--max-stretch", "1"},
                                                          {"--max-stretch", "nan"},
                                                          {"--max-distance", "0"},
                                                          {"--max-distance", "-1"},
                                                          {"--tolerance", "-0.1"},
                                                          {"--tolerance", "x"},
                                                          {"--tolerance", "0.2:-0.1"},
                                                          {"--tolerance", "0.1:"},
                                                          {"--tolerance", "0:1:2"},
                                                          {"--bands", "1,1"},
                                                          {"--field", "part"},
                                                          {"--field", "=4711"},
                                                          {"--field", "a\xff=1"},
                                                          {"--align-321", ""},
                                                          {"--field", "a=1", "--field", "a=2"},
                                                          {"--bands", "0,x"},
                                                          {"--range", "1"},
                                                          {"--range", "1", "1"},
                                                          {"--range", "2", "-2"},
                                                          {"--range", "0", "nan"},
                                                          {"--threads", "-1"},
                                                          {"--threads", "two"},
                                                          {"--transform-o1", "fot"},
                                                          {"--transform-o2", "scale"},
                                                          {"--transform-o1", "translate:1:2"},
                                                          {"--transform-o2", "fit,,fit"},
                                                          {"--unknown"},
                                                          {"c.obj"}};
  for (const auto& tail : wrong_tails) {
    auto arguments = start;
    arguments.insert(arguments.end(), tail.begin(), tail.end());
    const Outcome run = run_sdm(arguments);
    EXPECT_EQ(run.code, 2) << tail[0] << ' ' << tail.back() << '\n' << run.err;
    EXPECT_THAT(run.err, HasSubstr(tail[0]));
    EXPECT_EQ(run.out, "");
  }
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"map"},
        {"map", "a.obj", "-o", out},
        {"map", "a.obj", "b.obj"},
        {"mop"},
        {"info"},
        {"map", "a.obj", "b.obj", "-o"},
        {"map", "a.obj", "b.obj", "-o", out, "--tolerance", "2", "--max-distance", "1"},
        {"map", "a.obj", "b.obj", "-o", out, "--tolerance", "-2:0.5", "--max-distance", "1"}}) {
    const Outcome run = run_sdm(arguments);
    EXPECT_EQ(run.code, 2);
    EXPECT_NE(run.err, "");
  }
  EXPECT_TRUE(folder.empty());
}

// Names of files come from archives and downloads, too.
TEST(Usage, NoControlCharacterReachesTheTerminal) {
  const TemporaryFolder folder;
  const std::string name = "a\x1b[31m\u202e\u009b\xff.off", shown = "a\\u001b[31m\\u202e\\u009b\\xff.off";
  std::ofstream(folder / name) << "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  const auto all_printable = [](const std::string& text) {
    return text.find_first_of("\x1b\x7f\xff\a\r") == std::string::npos &&
           text.find("\u202e") == std::string::npos && text.find("\u009b") == std::string::npos;
  };
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"info", folder / name},
                                                    {"info", folder / ("missing " + name)},
                                                    {"info", "--" + name},
                                                    {"info", "a.off", name},
                                                    {name},
                                                    {"map", "a.off", "b.off", "-o", "out", "--sign", name}}) {
    const Outcome run = run_sdm(arguments);
    EXPECT_TRUE(all_printable(run.out)) << run.out;
    EXPECT_TRUE(all_printable(run.err)) << run.err;
    EXPECT_THAT(run.out + run.err, HasSubstr(shown));
  }
  // JSON has the name itself.
  const std::string other = (folder / "a\u202eb\x1b.off").string();
  std::filesystem::copy_file(folder / name, other);
  const Outcome json = run_sdm({"info", other, "--json"});
  EXPECT_TRUE(all_printable(json.out)) << json.out;
  EXPECT_EQ(nlohmann::json::parse(json.out)["file"].get<std::string>(), other);
}

// What a terminal shows: the verdict first and in colour, lines that fit, and last the page to open.
// Elsewhere, the same words without line breaks and colours.
TEST(Terminal, ShowsVerdictsInColourAndLinesThatFit) {
  const TemporaryFolder folder;
  const std::string o1 = write_obj(folder / "part.obj", ring(24)),
                    o2 = write_obj(folder / "plane.obj", square(8, -2));
  const std::vector<std::string> arguments{"map",         o1, o2, "-o", folder / "out", "--resolution", "64",
                                           "--tolerance", "1"};
  const auto shown = [&](std::uint16_t columns, std::vector<std::string> environment) {
    Outcome run = run_sdm(arguments, {.environment = std::move(environment), .columns = columns});
    EXPECT_EQ(run.code, 3) << run.err;
    std::erase(run.out, '\r');
    return run.out;
  };
  const std::string plain = shown(0, {"TERM=xterm"});
  EXPECT_TRUE(plain.starts_with("FAIL: " + o1));
  EXPECT_EQ(plain.find('\x1b'), std::string::npos);
  const std::string last = plain.substr(plain.rfind('\n', plain.size() - 2) + 1);
  EXPECT_EQ(last, "  page      " + std::string(folder / "out") + "/report.html\n");

  const std::string colored = shown(200, {"TERM=xterm", "NO_COLOR="});
  EXPECT_TRUE(colored.starts_with("\x1b[1;31mFAIL\x1b[0m: " + o1)) << colored;
  EXPECT_NE(colored.find("  tolerance \x1b[1;31mFAIL\x1b[0m: "), std::string::npos) << colored;
  for (const auto& environment :
       {std::vector<std::string>{"TERM=xterm", "NO_COLOR=1"}, {"TERM=dumb", "NO_COLOR="}})
    EXPECT_EQ(shown(200, environment).find('\x1b'), std::string::npos);

  const std::string narrow = shown(50, {"TERM=xterm", "NO_COLOR=1"});
  const auto words = [](std::string text) {
    std::erase_if(text, [](char c) { return c == ' ' || c == '\n'; });
    return text.substr(0, text.find("time"));
  };
  EXPECT_EQ(words(narrow), words(plain));
  std::istringstream lines(narrow);
  for (std::string line; std::getline(lines, line);) {
    const bool one_word = line.find(' ', line.find_first_not_of(' ')) == std::string::npos;
    EXPECT_TRUE(line.size() <= 50 || one_word) << line;
  }
  EXPECT_NE(narrow.find("\n            "), std::string::npos);
}

}  // namespace
}  // namespace sdm::test
