// The one way to use several cores. Bodies must not depend on how the range is cut or on the number of
// threads.
#pragma once

#include <sdm/progress.h>

#include <cstddef>
#include <functional>

namespace sdm {

/// Calls body(begin, end) for disjoint ranges that cover [0, count), of about `grain` or less, on all cores
/// allowed. With a progress callback, reports the fraction done, 1 at the end, and throws Cancelled when it
/// says so.
void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t begin, std::size_t end)>& body);
void parallel_for(std::size_t count, std::size_t grain, const Progress& progress, std::string_view step,
                  const std::function<void(std::size_t begin, std::size_t end)>& body);

/// Runs both, at the same time where a core is free. An exception of one comes out after the other is done or
/// was not begun; it never cuts loops within the other short.
void parallel_invoke(const std::function<void()>& first, const std::function<void()>& second);

/// Threads that parallel_for uses now.
[[nodiscard]] unsigned thread_count();

}  // namespace sdm
