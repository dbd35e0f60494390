// The kernel's copies by name: per instruction set one with eight lanes and one with four, for robots of up to four
// joints; which of them this build holds is said by kernel_targets.cmake.
#pragma once
#include "problem.hpp"

namespace pliant::mpc {

constexpr int few_joints = 4;

#define PLIANT_COPY(copy)                                      \
  namespace copy {                                             \
  const KernelTable* select_kernel(int dof, const ModelData&); \
  }
PLIANT_COPY(sse2)
PLIANT_COPY(sse2_four)
PLIANT_COPY(avx2)
PLIANT_COPY(avx2_four)
PLIANT_COPY(avx512)
PLIANT_COPY(avx512_four)
PLIANT_COPY(neon)
PLIANT_COPY(neon_four)
#undef PLIANT_COPY

}  // namespace pliant::mpc
