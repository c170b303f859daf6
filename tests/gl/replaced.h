// A driver whose functions a test can replace.
#pragma once

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <utility>

namespace sdm::test {

/// One of libepoxy's pointers to functions, replaced for as long as this lives.
template <class Function>
class Replaced {
 public:
  Replaced(Function& pointer, Function by) : pointer_(pointer), former_(std::exchange(pointer, by)) {}
  ~Replaced() { pointer_ = former_; }
  Replaced(const Replaced&) = delete;
  Replaced& operator=(const Replaced&) = delete;

 private:
  Function& pointer_;
  Function former_;
};

}  // namespace sdm::test
