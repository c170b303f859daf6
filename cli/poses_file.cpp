#include "poses_file.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <fstream>
#include <string>

#include "open_text.h"
#include "option_checks.h"

namespace {

std::vector<double> numbers_in(std::string_view line) {
  constexpr std::string_view kSeparators = " \t\r,;";
  constexpr std::size_t kMost = 16;
  line = line.substr(0, line.find('#'));
  std::vector<double> numbers;
  for (;;) {
    const std::size_t first = line.find_first_not_of(kSeparators);
    if (first == std::string_view::npos) return numbers;
    line.remove_prefix(first);
    const std::string_view word = line.substr(0, line.find_first_of(kSeparators));
    const std::optional<double> number = parse_number(word);
    if (!number) throw sdm::Error(fmt::format("{} is not a number", word.substr(0, 40)));
    if (numbers.size() == kMost) throw sdm::Error("more than 16 numbers");
    numbers.push_back(*number);
    line.remove_prefix(word.size());
  }
}

sdm::Transform pose_of(const std::vector<double>& numbers) {
  if (numbers.size() == 7)
    return sdm::Transform::translation({numbers[0], numbers[1], numbers[2]}) *
           sdm::Transform::quaternion({numbers[3], numbers[4], numbers[5], numbers[6]});
  if (numbers.size() != 12 && numbers.size() != 16)
    throw sdm::Error(fmt::format(
        "{} numbers; a pose has 7 (x y z, then a quaternion w x y z), 12 or 16 (a matrix)", numbers.size()));
  sdm::Transform pose;
  for (std::size_t i = 0; i < numbers.size(); ++i) pose.rows[i / 4][i % 4] = numbers[i];
  return pose;
}

}  // namespace

std::vector<sdm::Transform> read_poses(const std::filesystem::path& file, std::size_t count) {
  std::ifstream stream = open_text(file);
  std::vector<sdm::Transform> poses;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) try {
      const std::vector<double> numbers = numbers_in(line);
      if (numbers.empty()) continue;
      if (poses.size() == count)
        throw sdm::Error(fmt::format("more poses than bodies; there are {} bodies", count));
      poses.push_back(pose_of(numbers));
    } catch (const sdm::Error& problem) {
      throw sdm::Error(fmt::format("{}: line {}: {}", file.string(), number, problem.what()));
    }
  if (poses.size() < count)
    throw sdm::Error(fmt::format("{}: {} poses for {} bodies", file.string(), poses.size(), count));
  return poses;
}
