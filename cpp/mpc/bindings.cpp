// Python face of the core; meaning, shapes and units are in src/pliant/_mpc.pyi.
#include "../shared/contract.hpp"
#include "binding/bind_step.hpp"
#include "binding/chain_model.hpp"
#include "binding/node.hpp"
#include "binding/nodes.hpp"
#include "binding/part.hpp"
#include "binding/solver.hpp"

NB_MODULE(_mpc, m) {
  pliant::agree(m, "_mpc");
  using namespace pliant::mpc;
  m.attr("MAX_JOINTS") = max_joints;
  binding::bind_chain_and_model(m);
  binding::bind_nodes(m);
  binding::bind_node(m);
  binding::bind_solver(m);
  binding::bind_step(m);
  binding::bind_part(m);
  m.def("instruction_set", &instruction_set);
  m.def("available_instruction_sets", &available_instruction_sets);
  m.def("use_instruction_set", &use_instruction_set, nanobind::arg("name"));
}
