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

}  // namespace sdm::js
