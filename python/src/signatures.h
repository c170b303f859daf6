// Parts of the signatures that functions have in Python.
#pragma once

// The words of arguments and results: macros, as signatures are literals. python/sdm/_types.py has them, too.
#define SDM_SIGN "typing.Literal['automatic', 'none', 'exact', 'winding', 'side']"
#define SDM_ENGINE "typing.Literal['cpu', 'gl', 'gpu', 'reference']"
#define SDM_VERDICT "typing.Literal['pass', 'fail', 'not decided', 'doubtful']"
#define SDM_CERTAINTY "typing.Literal['exact', 'bounded', 'estimate']"

namespace sdm::python {

/// The last argument of a call that reports its progress, and what leads to its result.
inline constexpr const char* kProgress =
    "progress: collections.abc.Callable[[str, float], bool | None] | None = None) -> ";

}  // namespace sdm::python
