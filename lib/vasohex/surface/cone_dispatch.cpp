#include "vasohex/surface/cone_lanes_isa.h"

namespace vasohex::kernel {

bool add_cones(const ConeGroup& group, const double* x, GroupSum& sum) {
#ifdef VASOHEX_X86_KERNELS
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) {
    return avx512::add_cones(group, x, sum);
  }
  if (__builtin_cpu_supports("avx2")) {
    return avx2::add_cones(group, x, sum);
  }
#endif
  return baseline::add_cones(group, x, sum);
}

}  // namespace vasohex::kernel
