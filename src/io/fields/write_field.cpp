#include <fmt/format.h>
#include <sdm/error.h>
#include <sdm/map_files.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <new>

#include "core/memory.h"
#include "io/fields/formats.h"
#include "io/file/atomic_file.h"

namespace sdm {
namespace {

struct FieldFormat {
  const char *name, *extension;
  void (*write)(std::ostream& out, const DistanceField& field);
};

constexpr std::array<FieldFormat, 3> kFormats{{{"NumPy", ".npy", io::write_field_npy},
                                               {"VTK", ".vti", io::write_field_vti},
                                               {"OpenVDB", ".vdb", io::write_field_vdb}}};

const FieldFormat& format_of(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto found = std::ranges::find(kFormats, extension, &FieldFormat::extension);
  if (found == kFormats.end())
    throw Error(fmt::format("cannot write {}: the name of a field ends in one of {}", file.string(),
                            field_format_names()));
  return *found;
}

}  // namespace

std::string field_format_names() {
  std::string names;
  for (const FieldFormat& format : kFormats)
    names += fmt::format("{}{} ({})", names.empty() ? "" : ", ", format.extension, format.name);
  return names;
}

void check_field_format(const std::filesystem::path& file) {
  static_cast<void>(format_of(file));
}

void write_field(const std::filesystem::path& file, const DistanceField& field) try {
  const FieldFormat& format = format_of(file);
  const std::size_t count = field.grid.size();
  if (field.distance.size() != count || (!field.site.empty() && field.site.size() != count) ||
      field.site.size() != field.site_type.size())
    throw Error(fmt::format("cannot write {}: the arrays of the field do not fit its grid of {} points",
                            file.string(), count));
  io::AtomicFile out(file);
  format.write(out.stream(), field);
  out.commit();
} catch (const std::bad_alloc&) {
  throw out_of_memory("writing " + file.string());
}

}  // namespace sdm
