// Parts of the signatures that functions have in Python.
#pragma once

namespace sdm::python {

/// The last argument of a call that reports its progress, and what leads to its result.
inline constexpr const char* kProgress =
    "progress: collections.abc.Callable[[str, float], bool | None] | None = None) -> ";

}  // namespace sdm::python
