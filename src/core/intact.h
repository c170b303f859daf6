// Changes that cannot be undone.
//
// A change of a public object either fails before it has changed anything, or, where the change happens in
// place because copies would take too long, marks the object as broken.
#pragma once

#include <sdm/error.h>

#include <string>

namespace sdm::core {

/// Whether the last change of an object has ended.
class Intact {
 public:
  /// `object`: for the message, "a Sites object". It must be a literal.
  explicit constexpr Intact(const char* object) : object_(object) {}

  /// Throws sdm::Error if a change has failed. To be called first by all that reads or changes the object.
  void require() const {
    if (broken_) [[unlikely]]
      fail();
  }
  /// Calls change(). If that throws, require() will throw from then on.
  template <class Change>
  void change(const Change& change) {
    require();
    broken_ = true;
    change();
    broken_ = false;
  }

 private:
  [[noreturn]] void fail() const {
    throw Error("an earlier change of " + std::string(object_) +
                " failed half-way, which left it unusable; build a new one");
  }

  const char* object_;
  bool broken_ = false;
};

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
