#pragma once
/// \file The instruction sets that cone_lanes.cpp is compiled for.

#include "vasohex/surface/cone_lanes.h"

namespace vasohex::kernel {
namespace baseline {
bool add_cones(const ConeGroup& group, const double* x, GroupSum& sum);
}
namespace avx2 {
bool add_cones(const ConeGroup& group, const double* x, GroupSum& sum);
}
namespace avx512 {
bool add_cones(const ConeGroup& group, const double* x, GroupSum& sum);
}
}  // namespace vasohex::kernel
