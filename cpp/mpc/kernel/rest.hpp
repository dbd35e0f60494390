// The robot at rest in one configuration: what set-up and inspection need; not on the path of a solve.
#pragma once
#include "node.hpp"

namespace pliant::mpc::PLIANT_ISA {

template <int J>
struct alignas(64) Rest {
  MassMatrix<J> M;
  Frame tool, contact;
  Lanes contact_row[max_contact];       // J_c in contact axes
  double inverse_inertia[max_contact];  // diag(J M⁻¹ Jᵀ)
  Lanes gravity_torque;
};

template <int J>
[[gnu::noinline]] void make_rest(const Chain& chain, const ModelData& model, const Mat& task, const Lanes& q,
                                 Rest<J>& rest) {
  Pass<J> pass;
  begin_pass<J>(chain, Stage{}, q, zero(), pass);
  finish_dynamics<J>(chain, zero(), pass);
  const Kinematics& kin = pass.kin;
  const Dynamics& dyn = pass.dyn;
  mass_matrix<J>(chain, kin, dyn, rest.M);
  rest.tool = frame_on_last_link<J>(kin, chain.tool_rotation, chain.tool_translation);
  rest.contact = frame_on_last_link<J>(kin, chain.contact_rotation, chain.contact_translation);
  rest.gravity_torque = gravity_torque(kin, dyn, SpatialVec{{0, 0, 0}, {0, 0, 0}});
  const int dim = model.contact_dim;
  Contact c;
  make_contact<J>(chain, model, task, kin, pass.vel, dyn, dim, c);
  for (int i = 0; i < dim; ++i) {
    rest.contact_row[i] = c.J[i];
    rest.inverse_inertia[i] = sum(multiply<J>(pass.Minv.row, c.J[i]) * c.J[i]);
  }
}

}  // namespace pliant::mpc::PLIANT_ISA
