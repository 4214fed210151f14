#include "vasohex/quality/jacobian_kernel_isa.h"

namespace vasohex::kernel {

const JacobianKernel& jacobian_kernel() {
#ifdef VASOHEX_X86_KERNELS
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) {
    return avx512::kJacobianKernel;
  }
  if (__builtin_cpu_supports("avx2")) {
    return avx2::kJacobianKernel;
  }
#endif
  return baseline::kJacobianKernel;
}

}  // namespace vasohex::kernel
