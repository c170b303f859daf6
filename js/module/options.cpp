#include "module/options.h"

namespace sdm::js {

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
