#pragma once
/// \file The instruction sets that energy_kernel.cpp is compiled for.

#include "vasohex/blocks/energy_kernel.h"

namespace vasohex::kernel {
namespace baseline {
DistortionOutput distortion(const DistortionInput& in, double* gradient);
}
namespace avx2 {
DistortionOutput distortion(const DistortionInput& in, double* gradient);
}
namespace avx512 {
DistortionOutput distortion(const DistortionInput& in, double* gradient);
}
}  // namespace vasohex::kernel
