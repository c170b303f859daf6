// Exceptions, engines, threads.
#include <nanobind/stl/unique_ptr.h>

#include "objects.h"
#include "stored.h"

namespace sdm::python {
namespace {

// with thread_limit(4): ...
struct PyThreadLimit {
  unsigned count;
  std::unique_ptr<ThreadLimit> limit;
};

}  // namespace

std::shared_ptr<const Engine> engine_of(const char* name) {
  return make_engine(name);
}
void bind_errors(nb::module_& module) {
  // Translators are tried from the last one on.
  static nb::exception<Error> error(module, "Error", PyExc_ValueError);
  static nb::exception<Cancelled> cancelled(module, "Cancelled", error.ptr());
  error.attr("__doc__") =
      R"(An input that cannot be used, or a resource that is missing.

The message is one sentence that names the object, the fault and the remedy. A subclass of ValueError.)";
  cancelled.attr("__doc__") = "A progress callback returned False; there is no result.";

  module.def(
      "engines",
      [] {
        nb::list names;
        for (const EngineInfo& info : engines()) names.append(nb::str(info.name.data(), info.name.size()));
        return names;
      },
      nb::sig("def engines() -> list[str]"),
      R"(Returns the names of all engines, the default one first.

>>> sdm.engines()[0]
'cpu')");

  nb::class_<PyThreadLimit>(module, "thread_limit", nb::is_weak_referenceable(),
                            R"(Limits the threads that the library uses while a ``with`` block runs.

count: 0 means all cores. The smallest of several limits is in force, in all threads of
the process.

>>> with sdm.thread_limit(1):
...     distance_map = sdm.map(sphere, box, resolution=64)
)")
      .def(
          "__init__",
          [](PyThreadLimit* self, unsigned count) {
            new (self) PyThreadLimit{count, nullptr};
          },
          nb::arg("count"))
      .def(
          "__enter__",
          [](nb::handle self) {
            auto& limit = nb::cast<PyThreadLimit&>(self);
            limit.limit = std::make_unique<ThreadLimit>(limit.count);
            return nb::borrow(self);
          },
          nb::sig("def __enter__(self) -> thread_limit"))
      .def(
          "__exit__", [](PyThreadLimit& self, const nb::args&) { self.limit.reset(); },
          nb::sig("def __exit__(self, *exception: object) -> None"));
  bind_no_state<PyThreadLimit>("a thread_limit cannot be pickled or copied; make another one");
}

}  // namespace sdm::python
