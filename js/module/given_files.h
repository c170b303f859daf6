// The files that a mesh file may refer to: there is no file system.
#pragma once

#include <sdm/error.h>

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>

#include "io/file/error_prefix.h"

namespace sdm::js {

/// Contents by path, relative to the mesh file. Its readers find these, until this is destroyed.
class GivenFiles {
 public:
  explicit GivenFiles(std::map<std::string, std::string_view> files);
  ~GivenFiles();
  GivenFiles(const GivenFiles&) = delete;
  GivenFiles& operator=(const GivenFiles&) = delete;

  [[nodiscard]] const std::map<std::string, std::string_view>& all() const { return files_; }

 private:
  std::map<std::string, std::string_view> files_;
};

/// A mesh file and those that it may refer to, as JavaScript passes them. `names` and `contents`: of these
/// files, one after the other; `lengths`: of the name and the contents of each.
struct FileArguments {
  const char* bytes;
  std::uint32_t size;
  const char* name;
  std::uint32_t name_size;
  const char *names, *contents;
  const std::uint32_t* lengths;
  std::uint32_t files;

  [[nodiscard]] std::string_view content() const { return {bytes, size}; }
  [[nodiscard]] std::string path() const { return {name, name_size}; }
  [[nodiscard]] std::map<std::string, std::string_view> others() const;
};

/// Calls read(content, path) while the other files are given. Errors begin with the path.
template <class Read>
auto with_given_files(const FileArguments& file, const Read& read) {
  const GivenFiles given(file.others());
  const std::string path = file.path();
  return io::with_error_prefix(path, [&] {
    if (file.size == 0) throw Error("the file is empty");
    return read(file.content(), path);
  });
}

}  // namespace sdm::js
