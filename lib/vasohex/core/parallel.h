#pragma once
/// \file The only door to threads; parallel.cpp is the only file that knows oneTBB.

#include <cstddef>
#include <functional>

#include "vasohex/core/run.h"

namespace vasohex {

/// Calls `body(begin, end)` on disjoint ranges that cover [0, n), of at most `grain` indices each (grain >= 1), on
/// run.threads threads. The ranges do not depend on the number of threads. The first exception of a body is rethrown.
void parallel_for(const Run& run, std::size_t n, std::size_t grain,
                  const std::function<void(std::size_t begin, std::size_t end)>& body);

}  // namespace vasohex
