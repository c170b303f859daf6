#include "report.h"

#include <sdm/error.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <thread>

namespace sdm::bench {
namespace {

/// Whole numbers in full; others to three significant digits, or to the nearest whole number if that is
/// more precise.
std::string number(double value) {
  const double size = std::abs(value);
  const bool whole = value == std::round(value) && size < 1e15;
  const int magnitude = size > 0 && std::isfinite(size) ? static_cast<int>(std::floor(std::log10(size))) : 0;
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", whole ? 0 : std::clamp(2 - magnitude, 0, 9), value);
  return text;
}

/// The processor's name where the system provides it (Linux), otherwise empty.
std::string cpu_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("model name")) return line.substr(std::min(line.find(": ") + 2, line.size()));
  return {};
}

nlohmann::ordered_json to_json(const std::vector<Figure>& figures) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const Figure& figure : figures) json[figure.key] = figure.value;
  return json;
}

}  // namespace

void Table::print_heading(const Row& row) {
  std::vector<std::string> keys{"case"};
  if (!row.name.empty()) keys.push_back("part");
  for (const Figure& figure : row.figures) keys.push_back(figure.key);
  if (keys == keys_) return;
  if (!keys_.empty()) std::puts("");
  keys_ = std::move(keys);
  const std::size_t names = row.name.empty() ? 1 : 2;
  std::printf("|");
  for (const std::string& key : keys_) std::printf(" %s |", key.c_str());
  std::printf("\n|");
  for (std::size_t i = 0; i < keys_.size(); ++i) std::printf(i < names ? " --- |" : " ---: |");
  std::puts("");
}

void Table::print(const std::string& name, const Outcome& outcome) {
  for (const Row& row : outcome.rows) {
    print_heading(row);
    std::printf("| %s |", name.c_str());
    if (!row.name.empty()) std::printf(" %s |", row.name.c_str());
    for (const Figure& figure : row.figures) std::printf(" %s |", number(figure.value).c_str());
    std::puts("");
  }
  std::fflush(stdout);
}

JsonReport::JsonReport(const std::string& program, std::string file_name)
    : file_name_(std::move(file_name)), unfinished_(file_name_ + ".tmp") {
  if (!file_name_.empty()) file_.open(unfinished_);
  if (!file_) throw Error("cannot write " + unfinished_);
  json_ = {{"program", program},
           {"machine",
            {{"cpu", cpu_name()}, {"cores", std::thread::hardware_concurrency()}, {"compiler", __VERSION__}}},
           {"cases", nlohmann::ordered_json::object()}};
}

void JsonReport::add(const std::string& name, const Trial& trial, const Outcome& outcome) {
  nlohmann::ordered_json& json = json_["cases"][name];
  json = {{"verified", outcome.verified}, {"repetitions", trial.repetitions}, {"threads", trial.threads}};
  for (const Row& row : outcome.rows) {
    if (row.name.empty())
      json.update(to_json(row.figures));
    else
      json[row.name] = to_json(row.figures);
  }
  json.update(to_json(outcome.counts));
}

void JsonReport::commit() {
  if (file_name_.empty()) return;
  file_ << json_.dump(2) << '\n';
  file_.close();
  if (!file_) throw Error("cannot write " + unfinished_);
  std::filesystem::rename(unfinished_, file_name_);
}

}  // namespace sdm::bench
