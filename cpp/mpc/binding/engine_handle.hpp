// An engine of the chosen instruction set, owned.
#pragma once
#include <new>

#include "nodes.hpp"

namespace pliant::mpc::binding {

// Owns an engine of the instruction set chosen when it was made.
class EngineHandle {
 public:
  EngineHandle(const ChainData& chain, const ModelData& model, const Options& options)
      : table(&kernel(chain.dof, model)), engine(table->create(chain, model, options)) {
    if (!engine) throw std::bad_alloc();
  }
  EngineHandle(const EngineHandle&) = delete;
  EngineHandle& operator=(const EngineHandle&) = delete;
  ~EngineHandle() { table->destroy(engine); }

  const KernelTable* table;
  Engine* engine;
};

}  // namespace pliant::mpc::binding
