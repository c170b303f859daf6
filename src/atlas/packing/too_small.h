// Atlases whose resolution does not suffice.
#pragma once

#include <sdm/error.h>

#include <cstdint>
#include <string>

namespace sdm::atlas {

/// A resolution at which the atlas cannot be laid out; a larger one may do.
class TooSmall : public Error {
 public:
  TooSmall(const std::string& message, std::uint64_t enough)
      : Error(message, Remedy::resolution), enough_(enough) {}
  /// About the least resolution that would do.
  [[nodiscard]] std::uint64_t enough() const { return enough_; }

 private:
  std::uint64_t enough_;
};

}  // namespace sdm::atlas
