// Checks of user input; each throws std::invalid_argument with the rule and what was got.
#pragma once
#include "problem.hpp"

namespace pliant::mpc {

void validate(const ChainData& chain);
void validate(const ModelData& model);
void validate(const NodeData& node, int index, int dof, const ModelData& model, double dt);

}  // namespace pliant::mpc
