#include <sdm/align.h>

namespace sdm {

namespace {

constexpr std::string_view kAxes = "xyz";

}  // namespace

std::optional<AlignFreedoms> parse_freedoms(std::string_view text) {
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

std::vector<std::string> names_of(const AlignFreedoms& freedoms) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < 3; ++k)
    if (freedoms.translations[k]) names.emplace_back(1, kAxes[k]);
  for (std::size_t k = 0; k < 3; ++k)
    if (freedoms.rotations[k]) names.push_back(std::string("r") + kAxes[k]);
  return names;
}

bool OptionForm<AlignFreedoms>::read(std::string_view text, const OptionRange&, AlignFreedoms& value) {
  std::optional<AlignFreedoms> freedoms = parse_freedoms(text);
  if (!freedoms) return false;
  freedoms->about = value.about;
  value = *freedoms;
  return true;
}

std::string OptionForm<AlignFreedoms>::text(const AlignFreedoms& value) {
  return OptionForm<std::vector<std::string>>::text(names_of(value));
}

}  // namespace sdm
