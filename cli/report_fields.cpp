#include "report_fields.h"

#include <fmt/format.h>

#include <algorithm>

namespace {

constexpr const char* kFieldOption = "--field";

bool is_utf8(const std::string& text) {
  try {
    return !nlohmann::ordered_json(text).dump().empty();
  } catch (const nlohmann::ordered_json::type_error&) {
    return false;
  }
}

void add_field(ReportFields& fields, const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    throw CLI::ValidationError(kFieldOption, fmt::format("{} is not of the form NAME=TEXT", text));
  if (!is_utf8(text)) throw CLI::ValidationError(kFieldOption, "a text is not UTF-8");
  std::string name = text.substr(0, equals);
  if (std::ranges::count(fields, name, &ReportFields::value_type::first) > 0)
    throw CLI::ValidationError(kFieldOption, fmt::format("{} is given twice", name));
  fields.emplace_back(std::move(name), text.substr(equals + 1));
}

}  // namespace

void add_field_option(CLI::App& app, ReportFields& fields) {
  app.add_option_function<std::vector<std::string>>(
         kFieldOption,
         [&fields](const std::vector<std::string>& texts) {
           fields.clear();
           for (const std::string& text : texts) add_field(fields, text);
         },
         "State a fact in the report, such as part=4711 or inspector=...; may be repeated")
      ->allow_extra_args(false)
      ->type_name("NAME=TEXT");
}

void put_fields(nlohmann::ordered_json& report, const ReportFields& fields) {
  for (const auto& [name, text] : fields) report["fields"][name] = text;
}
