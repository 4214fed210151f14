#include "vasohex/blocks/energy_kernel_isa.h"

namespace vasohex::kernel {

DistortionOutput distortion(const DistortionInput& in, double* gradient) {
#ifdef VASOHEX_X86_KERNELS
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) {
    return avx512::distortion(in, gradient);
  }
  if (__builtin_cpu_supports("avx2")) {
    return avx2::distortion(in, gradient);
  }
#endif
  return baseline::distortion(in, gradient);
}

}  // namespace vasohex::kernel
