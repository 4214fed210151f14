#pragma once
/// \file How much processor time a piece of work took: unlike wall time, not blurred by what runs beside it.

namespace vasohex {

/// Seconds that the processor has spent on the calling thread so far.
double thread_cpu_seconds();

}  // namespace vasohex
