// The error for a resolution that is too small.
#pragma once

#include <sdm/error.h>

#include <cstdint>
#include <string>

namespace sdm::atlas {

/// The atlas cannot be laid out at this resolution; a larger one may suffice.
class TooSmall : public Error {
 public:
  TooSmall(const std::string& message, std::uint64_t enough)
      : Error(message, Remedy::resolution), enough_(enough) {}
  /// About the smallest resolution that would suffice.
  [[nodiscard]] std::uint64_t enough() const { return enough_; }

 private:
  std::uint64_t enough_;
};

}  // namespace sdm::atlas
