// The instruction-set copies by name; which of them this build holds is said by kernel_targets.cmake.
#pragma once
#include "problem.hpp"

namespace pliant::mpc {
namespace sse2 {
const KernelTable* select_kernel(int dof, const ModelData&);
}
namespace avx2 {
const KernelTable* select_kernel(int dof, const ModelData&);
}
namespace avx512 {
const KernelTable* select_kernel(int dof, const ModelData&);
}
namespace neon {
const KernelTable* select_kernel(int dof, const ModelData&);
}
}  // namespace pliant::mpc
