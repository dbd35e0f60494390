// One copy of the core: an instruction set and a number of lanes. Compiled several times, each with its own PLIANT_ISA,
// PLIANT_LANES and compiler flags; the only symbol that leaves it is select_kernel().
#include "../kernels.hpp"
#include "plan.hpp"

namespace pliant::mpc::PLIANT_ISA {
namespace {

template <class L>
void destroy(Engine* engine) {
  solver<L>(engine).~Solver<L>();
  free(engine);
}

template <class L>
Engine* create(const ChainData& chain, const ModelData& model, const Options& options) {
  void* memory = aligned_alloc(64, (sizeof(Solver<L>) + 63) / 64 * 64);
  if (!memory) return nullptr;
  Solver<L>* s = ::new (memory) Solver<L>();
  Engine* engine = reinterpret_cast<Engine*>(s);
  if (s->allocate(chain, model, options)) return engine;
  destroy<L>(engine);
  return nullptr;
}

template <class L>
void evaluate(Engine* engine, const NodeData& data, bool terminal, bool derivatives, const double* x, const double* u,
              NodeOutput& out) {
  Solver<L>& s = solver<L>(engine);
  NodeValues<L>& v = s.current().node[0];
  memset(static_cast<void*>(&v), 0xff, sizeof v);  // NaN everywhere: what the kernel forgets to write shows
  make_stage(data, s.model.data, s.model.disc, s.chain.dof, terminal, s.stages[0]);
  const Row<L> state = s.map.pack(x);
  s.evaluate_node(s.stages[0], state, load_part(u, s.chain.dof, 1), derivatives, v);
  if (terminal) {
    v.x_next = state;
    v.acceleration = zero();
    for (int c = 0; c < s.model.data.contact_dim; ++c) {
      v.force_rate[c] = 0;
      if (L::extra != Extra::force) v.force[c] = 0;
    }
  }
  const Dense<L> dense(s.map);
  out.cost = v.cost;
  dense.state_row(v.x_next, out.x_next);
  dense.joint_row(v.acceleration, out.acceleration);
  for (int c = 0; c < s.model.data.contact_dim; ++c) {
    out.force[c] = v.force[c];
    out.force_rate[c] = v.force_rate[c];
  }
  if (!derivatives) return;
  if (!terminal) {
    dense_tangent(s, v, out.fx, out.fu);
    dense_force(s, v, out);
  }
  dense_expansion(s, v, out);
}

template <class L>
double time_node(Engine* engine, const NodeData& data, bool terminal, bool derivatives, const double* x,
                 const double* u, int repetitions) {
  Solver<L>& s = solver<L>(engine);
  NodeValues<L>& v = s.current().node[0];
  make_stage(data, s.model.data, s.model.disc, s.chain.dof, terminal, s.stages[0]);
  const Row<L> state = s.map.pack(x);
  const Lanes control = load_part(u, s.chain.dof, 1);
  const double start = now_seconds();
  for (int i = 0; i < repetitions; ++i) s.evaluate_node(s.stages[0], state, control, derivatives, v);
  return (now_seconds() - start) / repetitions;
}

template <class L>
void freeze(Engine* engine, const double* task_rotation, const double* q) {
  Solver<L>& s = solver<L>(engine);
  s.freeze(mat(task_rotation), load_part(q, s.chain.dof, 1));
}

template <class L>
void quasi_static(Engine* engine, const NodeData* nodes, const double* x0) {
  Solver<L>& s = solver<L>(engine);
  const int N = s.options.horizon;
  Iterate<L>& it = s.current();
  const Row<L> x = s.map.pack(x0);
  for (int k = 0; k <= N; ++k) it.x[k] = x;
  Rest<L::J> rest;
  make_rest<L::J>(s.chain, s.model.data, mat(nodes[0].task_rotation), x.block[0] * s.chain.is_joint, rest);
  for (int k = 0; k < N; ++k) {
    it.u[k] = rest.gravity_torque;
    for (int f = 0; f < L::M && nodes[k].contact_active; ++f) it.u[k] -= rest.contact_row[f] * x[L::force_lane(f)];
  }
  if constexpr (L::has_torque)
    for (int k = 0; k <= N; ++k) it.x[k].block[2] = rest.gravity_torque;
}

template <class L>
void solve(Engine* engine, const NodeData* nodes, const double* x0, const Limits& limits, Report& report) {
  solver<L>(engine).solve(nodes, x0, limits, report);
}

template <class L>
void get_feedback(const Engine* engine, double* gain, double* forces) {
  const Solver<L>& s = solver<L>(engine);
  const Dense<L> dense(s.map);
  const StageFactor<L>& f = s.factors[0];
  for (int k = 0; gain && k < dense.nx; ++k) {  // R⁻ᵀ Y, column by column
    double column[lane_count] = {};
    for (int i = L::J - 1; i >= 0; --i) {
      double t = f.Y[i][s.map.lane(k)];
      for (int j = i + 1; j < L::J; ++j) t -= f.lower[j][i] * column[j];
      column[i] = t * f.reciprocal[i];
    }
    for (int i = 0; i < dense.n; ++i) gain[i * dense.nx + k] = column[i];
  }
  const int dim = s.model.data.contact_dim;
  for (int k = 0; forces && k < s.options.horizon; ++k)
    for (int c = 0; c < dim; ++c) forces[k * dim + c] = s.current().node[k].force[c];
}

template <int J>
void make_rest_of(const ChainData& data, const double* q, Rest<J>& rest) {
  make_rest<J>(make_chain(data, J), ModelData{}, Mat{}, load_part(q, data.dof, 1), rest);
}

template <int J>
void gravity_of(const ChainData& data, const double* q, double* torque) {
  Rest<J> rest;
  make_rest_of<J>(data, q, rest);
  for (int i = 0; i < data.dof; ++i) torque[i] = rest.gravity_torque[i];
}

template <int J>
void mass_matrix_of(const ChainData& data, const double* q, double* M) {
  Rest<J> rest;
  make_rest_of<J>(data, q, rest);
  for (int i = 0; i < data.dof; ++i)
    for (int j = i; j < data.dof; ++j) M[i * data.dof + j] = M[j * data.dof + i] = rest.M.row[i][j];
}

template <int J>
void placement(const ChainData& data, bool contact, const double* q, double* R, double* p) {
  Rest<J> rest;
  make_rest_of<J>(data, q, rest);
  const Frame& f = contact ? rest.contact : rest.tool;
  for (int i = 0; i < 9; ++i) R[i] = f.R.m[i];
  p[0] = f.p.x;
  p[1] = f.p.y;
  p[2] = f.p.z;
}

template <class L>
const KernelTable* table() {
  static constexpr KernelTable t = {
      create<L>,        destroy<L>,           evaluate<L>,        time_node<L>,       freeze<L>,
      set_plan<L>,      get_plan<L>,          shift<L>,           reset<L>,           quasi_static<L>,
      solve<L>,         get_feedback<L>,      get_multipliers<L>, set_multipliers<L>, tool_path<L>,
      gravity_of<L::J>, mass_matrix_of<L::J>, placement<L::J>};
  return &t;
}

template <int J>
const KernelTable* table_for(const ModelData& model) {
  if (model.kind == Kind::torque_feedback) return table<Layout<J, Extra::torque, 0>>();
  if (model.kind != Kind::force_feedback) return table<Layout<J, Extra::none, 0>>();
  if (model.contact_dim == 1) return table<Layout<J, Extra::force, 1>>();
  if (model.contact_dim == 3) return table<Layout<J, Extra::force, 3>>();
  return table<Layout<J, Extra::force, 6>>();
}

}  // namespace

const KernelTable* select_kernel(int dof, const ModelData& model) {
  // With four lanes a joint less would save little and cost the time to compile five layouts more.
  if constexpr (lane_count > 4) {
    if (dof < lane_count) return table_for<lane_count - 1>(model);
  }
  return table_for<lane_count>(model);
}

}  // namespace pliant::mpc::PLIANT_ISA
