// The instruction-set copies by name; which of them exist is a matter of the platform (see CMakeLists.txt).
#pragma once
#include "problem.hpp"

#if defined(__x86_64__) || defined(_M_X64)
#define PLIANT_X86 1
#endif

namespace pliant::mpc {
#ifdef PLIANT_X86
namespace sse2 { const KernelTable *select_kernel(int dof, const ModelData &); }
namespace avx2 { const KernelTable *select_kernel(int dof, const ModelData &); }
namespace avx512 { const KernelTable *select_kernel(int dof, const ModelData &); }
#else
namespace neon { const KernelTable *select_kernel(int dof, const ModelData &); }
#endif
} // namespace pliant::mpc
