#pragma once
/// \file The instruction sets that jacobian_kernel.cpp is compiled for.

#include "vasohex/quality/jacobian_kernel.h"

namespace vasohex::kernel {
namespace baseline {
extern const JacobianKernel kJacobianKernel;
}
namespace avx2 {
extern const JacobianKernel kJacobianKernel;
}
namespace avx512 {
extern const JacobianKernel kJacobianKernel;
}
}  // namespace vasohex::kernel
