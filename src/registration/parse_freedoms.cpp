#include <sdm/align.h>

namespace sdm {

std::optional<AlignFreedoms> parse_freedoms(std::string_view text) {
  constexpr std::string_view kAxes = "xyz";
  AlignFreedoms result{.translations = {}, .rotations = {}};
  for (bool more = true; more;) {
    const std::size_t comma = text.find(',');
    std::string_view word = text.substr(0, comma);
    more = comma != std::string_view::npos;
    if (more) text.remove_prefix(comma + 1);
    const bool turns = word.starts_with('r');
    if (turns) word.remove_prefix(1);
    if (word.empty()) return std::nullopt;
    for (const char letter : word) {
      const std::size_t axis = kAxes.find(letter);
      if (axis == std::string_view::npos) return std::nullopt;
      (turns ? result.rotations : result.translations)[axis] = true;
    }
  }
  return result;
}

}  // namespace sdm
