#include "dispatch.hpp"

#include <atomic>
#include <cstdlib>
#include <stdexcept>

#include "kernels.hpp"

namespace pliant::mpc {
namespace {

using Select = const KernelTable* (*)(int, const ModelData&);

struct InstructionSet {
  const char* name;
  Select select, select_four;  // copies with eight and with four lanes
  bool runs_here;
};

const std::vector<InstructionSet>& instruction_sets() {
  static const std::vector<InstructionSet> sets = [] {
    std::vector<InstructionSet> found;  // narrowest first
#ifdef PLIANT_HAS_NEON
    found.push_back({"neon", neon::select_kernel, neon_four::select_kernel, true});
#endif
#ifdef PLIANT_HAS_SSE2
    found.push_back({"sse2", sse2::select_kernel, sse2_four::select_kernel, true});
#endif
#ifdef PLIANT_HAS_AVX2
    __builtin_cpu_init();
    const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2");
    found.push_back({"avx2", avx2::select_kernel, avx2_four::select_kernel, avx2});
#endif
#ifdef PLIANT_HAS_AVX512
    const bool avx512 = avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                        __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
    found.push_back({"avx512", avx512::select_kernel, avx512_four::select_kernel, avx512});
#endif
    return found;
  }();
  return sets;
}

std::atomic<const InstructionSet*> chosen{nullptr};

const InstructionSet& find(const std::string& name, const char* source) {
  std::string valid;
  for (const InstructionSet& s : instruction_sets()) {
    if (!s.runs_here) continue;
    if (name == s.name) return s;
    valid += (valid.empty() ? "" : ", ") + std::string(s.name);
  }
  throw std::invalid_argument(std::string(source) + " names the instruction set '" + name +
                              "', which this machine or library does not offer; valid are: " + valid);
}

const InstructionSet& current() {
  if (const InstructionSet* s = chosen.load()) return *s;
  const InstructionSet* widest = nullptr;
  if (const char* wanted = std::getenv("PLIANT_ISA"); wanted && *wanted) {
    widest = &find(wanted, "PLIANT_ISA");
  } else {
    for (const InstructionSet& s : instruction_sets())
      if (s.runs_here) widest = &s;
  }
  chosen.store(widest);
  return *widest;
}

}  // namespace

std::vector<std::string> available_instruction_sets() {
  std::vector<std::string> names;
  for (const InstructionSet& s : instruction_sets())
    if (s.runs_here) names.emplace_back(s.name);
  return names;
}

std::string instruction_set() { return current().name; }

void use_instruction_set(const std::string& name) { chosen.store(&find(name, "use_instruction_set")); }

const KernelTable& kernel(int dof, const ModelData& model) {
  const InstructionSet& s = current();
  return *(dof <= few_joints ? s.select_four : s.select)(dof, model);
}

}  // namespace pliant::mpc
