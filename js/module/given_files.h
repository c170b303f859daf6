// The files that a mesh file may refer to: there is no file system.
#pragma once

#include <map>
#include <string>
#include <string_view>

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

}  // namespace sdm::js
