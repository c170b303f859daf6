// 4×4 matrices of affine maps: text, NPY, or the JSON of an alignment.
#include <fmt/format.h>
#include <sdm/error.h>
#include <sdm/mesh_files.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/excerpt.h"
#include "core/parse_number.h"
#include "io/file/byte_scanner.h"
#include "io/file/encodings.h"
#include "io/file/error_prefix.h"
#include "io/file/file_bytes.h"
#include "io/file/npy.h"

namespace sdm {

using namespace io;

namespace {

constexpr const char* kNeeded = "a 4×4 matrix, row by row, is needed";

std::vector<double> numbers_in_text(std::string_view text) {
  constexpr std::string_view kSeparators = " \t\r\n,;[]";
  std::vector<double> numbers;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    std::string_view rest = line.substr(0, line.find('#'));
    for (std::size_t at; (at = rest.find_first_not_of(kSeparators)) != std::string_view::npos;) {
      rest.remove_prefix(at);
      const std::string_view word = rest.substr(0, rest.find_first_of(kSeparators));
      rest.remove_prefix(word.size());
      const std::optional<double> number = core::parse_number(word);
      if (!number) throw Error(fmt::format("'{}' is not a number; {}", excerpt(word), kNeeded));
      numbers.push_back(*number);
    }
  }
  return numbers;
}

std::vector<double> numbers_in_npy(std::string_view bytes) {
  const NpyHeader header = parse_npy_header(bytes.substr(0, kMaxNpyHeader));
  if (header.shape != std::vector<std::uint64_t>{4, 4})
    throw Error(fmt::format("has the shape ({}); {}", fmt::join(header.shape, ", "), kNeeded));
  bytes.remove_prefix(header.data_begin);
  if (bytes.size() != 16 * header.number_bytes)
    throw Error("has another size than its header declares; it is truncated or damaged");
  std::vector<double> numbers(16);
  for (std::size_t i = 0; i < 16; ++i) {
    const char* at = bytes.data() + i * header.number_bytes;
    const std::size_t place = header.fortran_order ? i % 4 * 4 + i / 4 : i;
    numbers[place] =
        header.number_bytes == 4 ? load<float>(at, header.order) : load<double>(at, header.order);
  }
  return numbers;
}

std::vector<double> numbers_in_json(std::string_view text) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (json.is_discarded()) throw Error(fmt::format("invalid JSON; {}", kNeeded));
  const nlohmann::json* object = &json;
  if (object->contains("alignment")) object = &(*object)["alignment"];
  if (!object->is_object() || !object->contains("matrix"))
    throw Error(
        "has neither \"matrix\" nor \"alignment\" with \"matrix\", as alignment.json and report.json have");
  std::vector<double> numbers;
  for (const auto& row : (*object)["matrix"])
    for (const auto& number : row) {
      if (!number.is_number())
        throw Error(fmt::format("\"matrix\" does not consist of numbers; {}", kNeeded));
      numbers.push_back(number.get<double>());
    }
  return numbers;
}

std::vector<double> numbers_in(std::string_view bytes) {
  if (bytes.starts_with("\x93NUMPY")) return numbers_in_npy(bytes);
  refuse_encoded(bytes);
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);  // the UTF-8 byte order mark
  if (bytes.find_first_not_of(" \t\r\n") != std::string_view::npos &&
      bytes[bytes.find_first_not_of(" \t\r\n")] == '{')
    return numbers_in_json(bytes);
  return numbers_in_text(bytes);
}

void check_size(const std::filesystem::path& file) {
  constexpr std::uintmax_t kMost = std::uintmax_t{1} << 24;  // a report.json is far below it
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) throw Error(fmt::format("this is a folder; {}", kNeeded));
  if (const auto size = std::filesystem::file_size(file, error); !error && size > kMost)
    throw Error(fmt::format("is too large; {}", kNeeded));
}

}  // namespace

Transform read_matrix(const std::filesystem::path& file) {
  return with_error_prefix(file.string(), [&] {
    check_size(file);
    const std::vector<double> numbers = numbers_in(read_bytes(file).view());
    if (numbers.size() != 16)
      throw Error(fmt::format("has {} {}, not 16; {}", numbers.size(),
                              numbers.size() == 1 ? "number" : "numbers", kNeeded));
    Transform result;
    for (std::size_t i = 0; i < 16; ++i) {
      if (!std::isfinite(numbers[i])) throw Error("has a number that is infinite or NaN");
      result.rows[i / 4][i % 4] = numbers[i];
    }
    if (result.rows[3] != std::array<double, 4>{0, 0, 0, 1})
      throw Error("the last row is not 0 0 0 1; the translation is the last column, not the last row");
    if (result.orientation() == 0) throw Error("the matrix is singular: it would flatten the mesh");
    return result;
  });
}

}  // namespace sdm
