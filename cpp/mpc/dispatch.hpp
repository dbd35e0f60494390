// Which instruction-set copy runs.
#pragma once
#include <string>
#include <vector>

#include "problem.hpp"

namespace pliant::mpc {

// Copies in this library that this machine can run, narrowest first.
std::vector<std::string> available_instruction_sets();

// The chosen one: the widest available, or what PLIANT_ISA in the environment or use_instruction_set() names.
// Throws std::invalid_argument when that is unknown or cannot run here.
std::string instruction_set();
void use_instruction_set(const std::string& name);

const KernelTable& kernel(int dof, const ModelData& model);

}  // namespace pliant::mpc
