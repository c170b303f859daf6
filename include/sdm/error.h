/// The exceptions that the public functions throw. Kernels never throw.
///
/// A call that changes an object and throws *changes nothing*: the object is as it was, and the call may be
/// repeated. Where a change happens in place, because a copy would take longer than the change, a failure in
/// its midst *leaves the object broken* instead, if the documentation of the call says so: every later call
/// of the object throws sdm::Error, and it can only be destroyed or assigned to. References and spans that it
/// has returned remain valid, but what they refer to is unspecified. Wrong arguments never break an object; a
/// lack of memory may. A call that changes nothing can be repeated after any failure; an object that it was
/// to write its results to has unspecified values.
///
/// Threads: exceptions are values.
#pragma once

#include <sdm/types.h>

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
