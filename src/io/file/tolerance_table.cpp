#include <fmt/format.h>
#include <sdm/error.h>
#include <sdm/map_files.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "core/excerpt.h"
#include "core/parse_number.h"
#include "core/printable.h"
#include "io/file/file_bytes.h"
#include "io/file/text_scanner.h"

namespace sdm {
namespace {

constexpr const char* kTableNeeded =
    "a table of tolerances has the header \"group,lower,upper\" or \"group;lower;upper\", or is a JSON array "
    "of objects with these "
    "keys";

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r");
  return begin == std::string_view::npos ? ""
                                         : text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

std::vector<std::string> fields_of(std::string_view line, char separator) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"')
      fields.back() += line[i++];
    else if (line[i] == '"')
      quoted = !quoted;
    else if (line[i] == separator && !quoted)
      fields.emplace_back();
    else
      fields.back() += line[i];
  }
  for (std::string& field : fields) field = trimmed(field);
  return fields;
}

/// Where semicolons separate, the decimal mark may be a comma. `none`: what an empty field is.
double limit_of(const std::string& text, char separator, double none, std::size_t line) {
  if (text.empty()) return none;
  std::string number = text;
  if (separator == ';' && number.find('.') == std::string::npos) std::ranges::replace(number, ',', '.');
  const std::optional<double> value = core::parse_number(number);
  if (!value || !std::isfinite(*value))
    throw Error(fmt::format("line {}: '{}' is not a finite number", line, excerpt(text)));
  return *value;
}

void add_row(std::vector<GroupTolerance>& table, const std::string& group, double lower, double upper,
             const std::string& place) {
  if (group.empty()) throw Error(place + ": the group has no name");
  if (lower == -kInfinity && upper == kInfinity)
    throw Error(fmt::format("{}: group {} has no limit", place, group));
  if (lower > upper)
    throw Error(fmt::format("{}: the lower limit {} is above the upper one, {}", place, lower, upper));
  if (std::ranges::any_of(table, [&](const GroupTolerance& row) { return row.group == group; }))
    throw Error(fmt::format("{}: group {} has two rows", place, group));
  table.push_back({group, Tolerance(lower, upper)});
}

std::vector<GroupTolerance> table_in_csv(std::string_view text) {
  std::vector<GroupTolerance> table;
  char separator = 0;  // of the header
  for (std::size_t line = 1; !text.empty(); ++line) {
    const std::string_view row = trimmed(text.substr(0, text.find('\n')));
    text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
    if (row.empty()) continue;
    if (separator == 0) {
      separator = row.find(';') == std::string_view::npos ? ',' : ';';
      constexpr std::array<std::string_view, 3> kHeader{"group", "lower", "upper"};
      if (!std::ranges::equal(fields_of(row, separator), kHeader, io::same_word)) throw Error(kTableNeeded);
      continue;
    }
    const std::vector<std::string> fields = fields_of(row, separator);
    if (fields.size() != 3)
      throw Error(fmt::format("line {}: has {} fields between '{}', not group, lower and upper", line,
                              fields.size(), separator));
    add_row(table, fields[0], limit_of(fields[1], separator, -kInfinity, line),
            limit_of(fields[2], separator, kInfinity, line), fmt::format("line {}", line));
  }
  return table;
}

std::vector<GroupTolerance> table_in_json(std::string_view text) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_array()) throw Error(kTableNeeded);
  std::vector<GroupTolerance> table;
  for (const auto& row : json) {
    const std::string place = fmt::format("row {}", table.size() + 1);
    const auto is_limit = [&](const char* key) {
      return !row.contains(key) || row[key].is_null() ||
             (row[key].is_number() && std::isfinite(row[key].template get<double>()));
    };
    if (!row.is_object() || !row.contains("group") || !row["group"].is_string() || !is_limit("lower") ||
        !is_limit("upper"))
      throw Error(fmt::format("{}: {}", place, kTableNeeded));
    const auto limit = [&](const char* key, double none) {
      return !row.contains(key) || row[key].is_null() ? none : row[key].template get<double>();
    };
    add_row(table, row["group"].get<std::string>(), limit("lower", -kInfinity), limit("upper", kInfinity),
            place);
  }
  return table;
}

}  // namespace

std::vector<GroupTolerance> read_tolerance_table(const std::filesystem::path& file) try {
  io::require_regular_file(file, "table");
  std::ifstream in(file, std::ios::binary);
  if (!in) throw Error("cannot be opened");
  std::string text{std::istreambuf_iterator<char>(in), {}};
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);  // the UTF-8 byte order mark
  if (text.find('\0') != std::string::npos) throw Error("is not text: it has a byte 0");
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  std::vector<GroupTolerance> table = first != std::string::npos && (text[first] == '[' || text[first] == '{')
                                          ? table_in_json(text)
                                          : table_in_csv(text);
  if (table.empty()) throw Error(fmt::format("has no rows; {}", kTableNeeded));
  return table;
} catch (const Error& fault) {
  throw Error(printable(file.string() + ": " + fault.what()));
}

}  // namespace sdm
