/// The exceptions that the public functions throw. Kernels never throw.
///
/// Threads: exceptions are values.
#pragma once

#include <sdm/api.h>

#include <stdexcept>
#include <string>

namespace sdm {

/// The option that remedies an error, for programs that expose it under another name.
enum class Remedy { none, atlas_kind, resolution, sign_method };

/// Invalid input or a missing resource. The message is one sentence that names the object, the fault and the
/// remedy.
class SDM_API Error : public std::runtime_error {
 public:
  /// An error with its message, and the option that remedies it.
  explicit Error(const std::string& message, Remedy remedy = Remedy::none)
      : std::runtime_error(message), remedy_(remedy) {}

  /// The option that remedies the error.
  [[nodiscard]] Remedy remedy() const { return remedy_; }

 private:
  Remedy remedy_;
};

/// A progress callback requested cancellation; there is no result.
class SDM_API Cancelled : public Error {
 public:
  Cancelled() : Error("cancelled") {}
};

}  // namespace sdm
