#include "io/file/npy.h"

#include <fmt/format.h>
#include <sdm/error.h>
#include <sdm/map_files.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <new>
#include <string>

#include "core/excerpt.h"
#include "core/memory.h"
#include "io/file/atomic_file.h"
#include "io/file/byte_scanner.h"
#include "io/file/little_endian.h"

namespace sdm::io {
namespace {

[[noreturn]] void refuse() {
  throw Error("the header is not as NumPy writes it; the file is damaged");
}

// A Python dictionary, limited to what NumPy writes: strings, True or False, tuples of whole numbers.
class Dictionary {
 public:
  explicit Dictionary(std::string_view text) : rest_(text) {}

  bool accept(std::string_view token) {
    skip_blanks();
    if (!rest_.starts_with(token)) return false;
    rest_.remove_prefix(token.size());
    return true;
  }
  void expect(std::string_view token) {
    if (!accept(token)) refuse();
  }
  std::string_view string() {
    skip_blanks();
    if (rest_.empty() || (rest_[0] != '\'' && rest_[0] != '"')) refuse();
    const std::size_t end = rest_.find(rest_[0], 1);
    if (end == std::string_view::npos) refuse();
    const std::string_view text = rest_.substr(1, end - 1);
    if (std::ranges::any_of(text, [](char c) { return c < ' '; })) refuse();  // it may appear in a message
    rest_.remove_prefix(end + 1);
    return text;
  }
  std::uint64_t number() {
    skip_blanks();
    std::uint64_t value = 0;
    const auto [end, fault] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
    if (fault != std::errc{}) refuse();
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    return value;
  }
  std::vector<std::uint64_t> tuple() {
    std::vector<std::uint64_t> values;
    expect("(");
    while (!accept(")")) {
      values.push_back(number());
      if (!accept(",")) {
        expect(")");
        break;
      }
    }
    return values;
  }
  void expect_end() {
    skip_blanks();
    if (!rest_.empty()) refuse();
  }

 private:
  void skip_blanks() { rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t\n"), rest_.size())); }

  std::string_view rest_;
};

void set_type(NpyHeader& header, std::string_view type) {
  if (type == "<f4" || type == ">f4") {
    header.number_bytes = 4;
  } else if (type == "<f8" || type == ">f8") {
    header.number_bytes = 8;
  } else {
    throw Error(fmt::format(
        "holds numbers of type '{}', not float32 or float64; convert them with astype(numpy.float32)",
        excerpt(type)));
  }
  header.order = type[0] == '<' ? std::endian::little : std::endian::big;
}

}  // namespace

NpyHeader parse_npy_header(std::string_view bytes) {
  if (!bytes.starts_with("\x93NUMPY")) throw Error("this is not an NPY file; save it with numpy.save");
  ByteScanner in(bytes);
  in.take(6);
  const auto version = in.number<std::uint8_t>();
  in.take(1);
  if (version < 1 || version > 3)
    throw Error(fmt::format("NPY version {} is not supported, only 1 to 3", version));
  const std::size_t length = version == 1 ? in.number<std::uint16_t>() : in.number<std::uint32_t>();
  Dictionary text(in.take(length));

  NpyHeader header;
  header.data_begin = bytes.size() - in.remaining();
  int keys = 0;
  text.expect("{");
  while (!text.accept("}")) {
    const std::string_view key = text.string();
    text.expect(":");
    if (key == "descr") {
      if (text.accept("["))
        throw Error("holds records, not plain numbers; save an array of float32 or float64");
      set_type(header, text.string());
      keys |= 1;
    } else if (key == "fortran_order") {
      header.fortran_order = text.accept("True");
      if (!header.fortran_order) text.expect("False");
      keys |= 2;
    } else if (key == "shape") {
      header.shape = text.tuple();
      keys |= 4;
    } else {
      refuse();
    }
    if (!text.accept(",")) {
      text.expect("}");
      break;
    }
  }
  text.expect_end();
  if (keys != 7) refuse();
  return header;
}

}  // namespace sdm::io

namespace sdm {

std::string io::npy_header(std::string_view type, std::span<const std::uint64_t> shape, NpyOrder order) {
  const char* quote = type.starts_with('[') ? "" : "'";
  std::string dictionary = fmt::format("{{'descr': {0}{1}{0}, 'fortran_order': {2}, 'shape': ({3}{4}), }}",
                                       quote, type, order == NpyOrder::first_fastest ? "True" : "False",
                                       fmt::join(shape, ", "), shape.size() == 1 ? "," : "");
  std::string header = "\x93NUMPY";
  header += {'\1', '\0'};
  constexpr std::size_t kStep = 64, kLeast = 128;
  const std::size_t size = std::max(kLeast, (header.size() + 2 + dictionary.size() + kStep) / kStep * kStep);
  append_little_endian(header, static_cast<std::uint16_t>(size - header.size() - 2));
  dictionary.resize(size - header.size() - 1, ' ');
  return header + dictionary + '\n';
}

void write_npy(const std::filesystem::path& file, std::uint32_t resolution,
               std::span<const std::uint32_t> values) try {
  if (resolution == 0 || values.empty() || values.size() % resolution != 0)
    throw Error(fmt::format("cannot write {}: {} values are not whole rows of {} texels", file.string(),
                            values.size(), resolution));
  const std::uint64_t rows = values.size() / resolution;
  io::AtomicFile out(file);
  out.stream() << io::npy_header("<u4", std::array<std::uint64_t, 2>{rows, resolution});
  std::string bytes;
  bytes.reserve(values.size_bytes());
  for (const std::uint32_t value : values) io::append_little_endian(bytes, value);
  out.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.commit();
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

}  // namespace sdm
