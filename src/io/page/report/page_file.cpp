#include "io/page/report/page_file.h"

#include <fmt/chrono.h>
#include <sdm/version.h>

#include <bit>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <span>
#include <stdexcept>
#include <vector>

namespace sdm::io {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kDataPlace = "<!-- data -->";  // in the page

std::vector<std::uint32_t> bits_of(std::span<const float> values) {
  std::vector<std::uint32_t> bits;
  for (const float value : values) bits.push_back(std::bit_cast<std::uint32_t>(value));
  return bits;
}

/// The time in UTC, or that of SOURCE_DATE_EPOCH, for builds that repeat to the byte.
std::string date() {
  std::int64_t seconds =
      std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now()).time_since_epoch().count();
  if (const char* fixed = std::getenv("SOURCE_DATE_EPOCH"))
    std::from_chars(fixed, fixed + std::string_view(fixed).size(), seconds);
  const std::chrono::sys_seconds time{std::chrono::seconds(seconds)};
  return fmt::format("{:%Y-%m-%dT%H:%MZ}", fmt::gmtime(std::chrono::system_clock::to_time_t(time)));
}

// JSON as the content of a <script> element, which ends at "</script" and may not contain "<!--".
std::string as_script(const std::string& json) {
  std::string text;
  text.reserve(json.size());
  for (const char c : json)
    if (c == '<')
      text += "\\u003c";
    else
      text += c;
  return text;
}

}  // namespace

Json add_area(PackedArrays& arrays, const AreaByValue& area) {
  arrays.add("area_key", area.keys);
  arrays.add("area_of_key", bits_of(area.area_of_key));
  arrays.add("area_of_bin", bits_of(area.area));
  return {{"lo", area.lower}, {"hi", area.upper}, {"without_value", area.without_value}};
}

Json common_json(UpAxis up) {
  return {{"version", kVersion}, {"date", date()}, {"up", up == UpAxis::z ? "z" : "y"}};
}

void put_page(std::ostream& out, std::string_view html, Json& page, const std::string* report,
              const PackedArrays& arrays) {
  if (arrays.index().is_null())
    throw std::logic_error("the arrays of a page are compressed before it is written");
  page["arrays"] = arrays.index();
  const std::size_t middle = html.find(kDataPlace);
  out << html.substr(0, middle);
  if (report) out << R"(<script type="application/json" id="report">)" << as_script(*report) << "</script>\n";
  out << R"(<script type="application/json" id="page">)"
      << as_script(page.dump(-1, ' ', false, Json::error_handler_t::ignore)) << "</script>\n"
      << R"(<script type="text/plain" id="arrays">)" << arrays.text() << "</script>"
      << html.substr(middle + kDataPlace.size());
}

}  // namespace sdm::io
