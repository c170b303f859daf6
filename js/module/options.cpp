#include "module/options.h"

namespace sdm::js {

bool read_tolerance(const GivenValue& given, std::optional<Tolerance>& value) {
  if (given.words.starts_with('"'))
    return OptionForm<std::optional<Tolerance>>::read(given.text(), OptionRange{}, value);
  std::vector<double> numbers;
  if (!read_numbers(given.words, {-kInfinity, kInfinity}, 0, numbers)) return false;
  const bool one = numbers.size() == 1;
  if (numbers.size() > 2 || one != !std::isnan(given.number)) return false;
  const Tolerance read = one ? Tolerance(numbers[0]) : Tolerance(numbers[0], numbers[1]);
  if (!(read.lower <= read.upper) || (std::isinf(read.lower) && std::isinf(read.upper))) return false;
  value = read;
  return true;
}

std::vector<GivenValue> values_of(const GivenOptions& given) {
  std::vector<GivenValue> values;
  std::string_view rest(given.lines, given.bytes);
  while (!rest.empty()) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    const std::size_t equals = line.find('=');
    values.push_back({line.substr(0, equals), line.substr(equals + 1), given.numbers[values.size()]});
    rest.remove_prefix(line.size() + 1);
  }
  return values;
}

const OptionInfo& option_of(const GivenValue& given, std::span<const OptionInfo> declared) {
  std::vector<std::string> names;
  for (const OptionInfo& option : declared) {
    names.push_back(spelled(option.name, Spelling::camel_case));
    if (names.back() == given.name) return option;
  }
  throw Error(unknown_name("option", given.name, names));
}

void refuse(const OptionInfo& option, const GivenValue& given) {
  throw Error(refused(option, given.words, Spelling::camel_case));
}

}  // namespace sdm::js
