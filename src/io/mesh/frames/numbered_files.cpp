#include "io/mesh/frames/numbered_files.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include <algorithm>
#include <charconv>
#include <numeric>
#include <optional>
#include <string_view>

#include "io/mesh/read_polygons.h"

namespace sdm::io {
namespace {

namespace fs = std::filesystem;

// A name, split at its number.
struct Name {
  std::string_view before, digits, after;
};

constexpr std::string_view kDigits = "0123456789";

// Splits a name if its stem ends in digits.
std::optional<Name> split_at_number(std::string_view name) {
  const std::size_t dot = name.rfind('.');
  if (dot == std::string_view::npos || dot == 0) return std::nullopt;
  const std::size_t last = name.substr(0, dot).find_last_not_of(kDigits);
  const std::size_t begin = last == std::string_view::npos ? 0 : last + 1;
  if (begin == dot) return std::nullopt;
  return Name{name.substr(0, begin), name.substr(begin, dot - begin), name.substr(dot)};
}

// A pattern, split at its number.
struct Pattern {
  std::string before, after;
  std::optional<std::size_t> width;  // the minimum number of digits; none for *, which matches any number
};

Pattern parse_pattern(const std::string& text) {
  const std::size_t begin = text.find_first_of("%*");
  std::size_t end = begin + 1;
  Pattern pattern{text.substr(0, begin), {}, {}};
  if (text[begin] == '%') {
    pattern.width = 1;
    if (end + 1 < text.size() && text[end] == '0' && text[end + 1] >= '1' && text[end + 1] <= '9') {
      pattern.width = static_cast<std::size_t>(text[end + 1] - '0');
      end += 2;
    }
    if (end == text.size() || text[end++] != 'd')
      throw Error("in a pattern, % must be followed by d, or by a width and d, as in walk_%04d.ply");
  }
  pattern.after = text.substr(end);
  if (pattern.after.find_first_of("%*") != std::string::npos)
    throw Error("a pattern must have only one number, as in walk_%04d.ply or walk_*.ply");
  return pattern;
}

// Returns the digits of the number if the name is as printf would print it.
std::optional<std::string_view> match(const Pattern& pattern, std::string_view name) {
  const std::size_t around = pattern.before.size() + pattern.after.size();
  if (name.size() <= around || !name.starts_with(pattern.before) || !name.ends_with(pattern.after))
    return std::nullopt;
  const std::string_view digits = name.substr(pattern.before.size(), name.size() - around);
  if (digits.find_first_not_of(kDigits) != std::string_view::npos) return std::nullopt;
  if (pattern.width &&
      (digits.size() < *pattern.width || (digits.size() > *pattern.width && digits[0] == '0')))
    return std::nullopt;
  return digits;
}

std::uint64_t to_number(std::string_view digits, const std::string& name) {
  std::uint64_t number = 0;
  if (std::from_chars(digits.data(), digits.data() + digits.size(), number).ec != std::errc{} ||
      number > UINT64_MAX / 2)
    throw Error(fmt::format("the number in {} is too large; number the files from 0", name));
  return number;
}

// Calls visit with the path of each regular file.
template <typename Visit>
void for_each_file(const fs::path& folder, const Visit& visit) {
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code ignored;
    if (entry->is_regular_file(ignored)) visit(entry->path());
  }
  if (error) throw Error(fmt::format("the folder {} cannot be read: {}", folder.string(), error.message()));
}

}  // namespace

NumberedFiles NumberedFiles::like(const fs::path& pattern) {
  const Pattern parsed = parse_pattern(pattern.filename().string());
  std::vector<File> files;
  for_each_file(pattern.has_parent_path() ? pattern.parent_path() : ".", [&](const fs::path& path) {
    const std::string name = path.filename().string();
    if (const auto digits = match(parsed, name)) files.push_back({to_number(*digits, name), path});
  });
  if (files.empty()) throw Error("no file matches the pattern");
  return NumberedFiles(std::move(files));
}

NumberedFiles NumberedFiles::in(const fs::path& folder) {
  std::vector<File> files;
  std::string model;  // the name that the others must match
  for_each_file(folder, [&](const fs::path& path) {
    const std::string name = path.filename().string();
    const auto parts = split_at_number(name);
    if (!parts || !is_mesh_extension(parts->after)) return;
    if (model.empty()) model = name;
    const auto expected = split_at_number(model);
    if (parts->before != expected->before || parts->after != expected->after)
      throw Error(
          fmt::format("holds several sequences, as {} and {} show; choose one with a pattern such as {}*{}",
                      std::min(name, model), std::max(name, model), expected->before, expected->after));
    files.push_back({to_number(parts->digits, name), path});
  });
  if (files.empty())
    throw Error("the folder has no mesh files whose names end in a number, as in walk_0001.ply");
  return NumberedFiles(std::move(files));
}

NumberedFiles::NumberedFiles(std::vector<File> files) : files_(std::move(files)) {
  std::ranges::sort(files_, {}, &File::number);
  std::uint64_t step = 0;
  for (std::size_t i = 1; i < files_.size(); ++i) {
    if (files_[i].number == files_[i - 1].number) {
      const auto names =
          std::minmax({files_[i - 1].path.filename().string(), files_[i].path.filename().string()});
      throw Error(
          fmt::format("{} and {} have the same number; remove one of them", names.first, names.second));
    }
    step = std::gcd(step, files_[i].number - files_[i - 1].number);
  }
  step_ = std::max<std::uint64_t>(step, 1);
  if (count() - files_.size() > files_.size())
    throw Error(
        fmt::format("of the numbers from {} to {}, only {} have a file; number the files consecutively",
                    files_.front().number, files_.back().number, files_.size()));
}

std::size_t NumberedFiles::count() const {
  return (files_.back().number - files_.front().number) / step_ + 1;
}

fs::path NumberedFiles::file(std::size_t index) const {
  const auto found = std::ranges::lower_bound(files_, number(index), {}, &File::number);
  return found != files_.end() && found->number == number(index) ? found->path : fs::path();
}

}  // namespace sdm::io
