#include <fmt/format.h>
#include <sdm/error.h>
#include <sdm/tolerance_table.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "core/excerpt.h"
#include "core/parse_number.h"
#include "core/printable.h"

namespace sdm {
namespace {

constexpr const char* kTableNeeded =
    "a table of tolerances has the header \"group,lower,upper\", or is a JSON array of objects with these "
    "keys";

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r");
  return begin == std::string_view::npos ? ""
                                         : text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

std::vector<std::string> fields_of(std::string_view line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"')
      fields.back() += line[i++];
    else if (line[i] == '"')
      quoted = !quoted;
    else if (line[i] == ',' && !quoted)
      fields.emplace_back();
    else
      fields.back() += line[i];
  }
  for (std::string& field : fields) field = trimmed(field);
  return fields;
}

double limit_of(const std::string& text, std::size_t line) {
  const std::optional<double> value = core::parse_number(text);
  if (!value) throw Error(fmt::format("line {}: '{}' is not a number", line, excerpt(text)));
  return *value;
}

void add_row(std::vector<GroupTolerance>& table, const std::string& group, double lower, double upper,
             const std::string& place) {
  if (group.empty()) throw Error(place + ": the group has no name");
  if (!std::isfinite(lower) || !std::isfinite(upper) || lower > upper)
    throw Error(fmt::format("{}: the limits {} and {} are not finite and in order", place, lower, upper));
  if (std::ranges::any_of(table, [&](const GroupTolerance& row) { return row.group == group; }))
    throw Error(fmt::format("{}: group {} has two rows", place, group));
  table.push_back({group, Tolerance(lower, upper)});
}

std::vector<GroupTolerance> table_in_csv(std::string_view text) {
  std::vector<GroupTolerance> table;
  bool header = false;
  for (std::size_t line = 1; !text.empty(); ++line) {
    const std::string_view row = trimmed(text.substr(0, text.find('\n')));
    text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
    if (row.empty()) continue;
    const std::vector<std::string> fields = fields_of(row);
    if (!header) {
      if (fields != std::vector<std::string>{"group", "lower", "upper"}) throw Error(kTableNeeded);
      header = true;
      continue;
    }
    if (fields.size() != 3)
      throw Error(fmt::format("line {}: has {} fields, not group, lower and upper", line, fields.size()));
    add_row(table, fields[0], limit_of(fields[1], line), limit_of(fields[2], line),
            fmt::format("line {}", line));
  }
  return table;
}

std::vector<GroupTolerance> table_in_json(std::string_view text) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_array()) throw Error(kTableNeeded);
  std::vector<GroupTolerance> table;
  for (const auto& row : json) {
    const std::string place = fmt::format("row {}", table.size() + 1);
    if (!row.is_object() || !row.contains("group") || !row["group"].is_string() || !row.contains("lower") ||
        !row["lower"].is_number() || !row.contains("upper") || !row["upper"].is_number())
      throw Error(fmt::format("{}: {}", place, kTableNeeded));
    add_row(table, row["group"].get<std::string>(), row["lower"].get<double>(), row["upper"].get<double>(),
            place);
  }
  return table;
}

}  // namespace

std::vector<GroupTolerance> read_tolerance_table(const std::filesystem::path& file) try {
  if (std::filesystem::is_directory(file)) throw Error("is a folder");
  std::ifstream in(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  if (in.fail() && text.empty()) throw Error("cannot be read");
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
