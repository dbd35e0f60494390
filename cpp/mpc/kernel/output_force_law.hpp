// The contact force as an output of (q, v, τ), with its derivatives: rigid [FFMPC sections III-C, IV-C] and naive
// visco-elastic (section V-B).
#pragma once
#include "node.hpp"

namespace pliant::mpc::PLIANT_ISA {

// λ and its derivatives, as an output of (q, v, τ).
struct OutputForce {
  double value[max_contact];
  Lanes by_q[max_contact], by_v[max_contact], by_torque[max_contact];
};

// Solves (J M⁻¹ Jᵀ) X = Y in place by Cholesky; small and dense.
struct TaskInertia {
  int dim;
  double lower[max_contact][max_contact], reciprocal[max_contact];

  template <class T>
  PLIANT_INLINE void solve(T* y) const {
    for (int i = 0; i < dim; ++i) {
      for (int k = 0; k < i; ++k) y[i] = y[i] - y[k] * lower[i][k];
      y[i] = y[i] * reciprocal[i];
    }
    for (int i = dim - 1; i >= 0; --i) {
      for (int k = i + 1; k < dim; ++k) y[i] = y[i] - y[k] * lower[k][i];
      y[i] = y[i] * reciprocal[i];
    }
  }
};

// J M⁻¹ (rows) and the factor of J M⁻¹ Jᵀ.
template <int J>
PLIANT_INLINE void task_inertia(const Contact& c, const Inverse<J>& Minv, int dim, Lanes* JMinv, TaskInertia& task) {
  task.dim = dim;
  for (int i = 0; i < dim; ++i) JMinv[i] = multiply<J>(Minv.row, c.J[i]);
  for (int j = 0; j < dim; ++j) {
    for (int i = j; i < dim; ++i) {
      double t = sum(JMinv[i] * c.J[j]);
      for (int k = 0; k < j; ++k) t -= task.lower[i][k] * task.lower[j][k];
      if (i == j) {
        task.lower[j][j] = sqrt(t);
        task.reciprocal[j] = 1 / task.lower[j][j];
      } else {
        task.lower[i][j] = t * task.reciprocal[j];
      }
    }
  }
}

// Everything the models below need besides the pass.
template <int J>
struct OutputPass {
  Pass<J> pass;
  Contact contact;
  int dim;  // 0 when there is no contact
  bool rigid;
  Lanes JMinv[max_contact];
  TaskInertia task;
  double deflection[max_contact];
  Lanes deflection_q[max_contact];
  OutputForce force;
};

// Rigid contact, Gauss's principle [FFMPC eq. 3–4] with Baumgarte's terms: J v̇ + dJ/dt v + kd J v + kp e = 0.
template <int J>
PLIANT_INLINE void rigid_force(const ModelData& model, const Lanes& free_acceleration, OutputPass<J>& o) {
  const Contact& c = o.contact;
  task_inertia<J>(c, o.pass.Minv, o.dim, o.JMinv, o.task);
  for (int i = 0; i < o.dim; ++i)
    o.force.value[i] = -(sum(c.J[i] * free_acceleration) + c.drift[i] + model.baumgarte_velocity * c.speed[i] +
                         model.baumgarte_position * o.deflection[i]);
  o.task.solve(o.force.value);
}

template <int J>
PLIANT_INLINE void visco_elastic_force(const Stage& s, OutputPass<J>& o) {  // [FFMPC eq. 16]
  for (int i = 0; i < o.dim; ++i)
    o.force.value[i] = -s.stiffness[i] * o.deflection[i] - s.damping[i] * o.contact.speed[i];
}

// Derivatives of λ; a_q and a_v hold −M⁻¹ ∂ID/∂q and −M⁻¹ ∂ID/∂v (rows).
template <int J>
PLIANT_INLINE void rigid_force_derivatives(const ModelData& model, const ContactDerivatives& cd, const Lanes* a_q,
                                           const Lanes* a_v, OutputPass<J>& o) {
  const Contact& c = o.contact;
  OutputForce& f = o.force;
  for (int i = 0; i < o.dim; ++i) {
    Lanes by_q =
        cd.acceleration_q[i] + cd.speed_q[i] * model.baumgarte_velocity + o.deflection_q[i] * model.baumgarte_position;
    Lanes by_v = cd.acceleration_v[i] + c.J[i] * model.baumgarte_velocity;
#pragma GCC unroll 8
    for (int k = 0; k < J; ++k) {
      by_q += a_q[k] * c.J[i][k];
      by_v += a_v[k] * c.J[i][k];
    }
    f.by_q[i] = -by_q;
    f.by_v[i] = -by_v;
    f.by_torque[i] = -o.JMinv[i];
  }
  o.task.solve(f.by_q);
  o.task.solve(f.by_v);
  o.task.solve(f.by_torque);
}

template <int J>
PLIANT_INLINE void visco_elastic_force_derivatives(const Stage& s, const ContactDerivatives& cd, OutputPass<J>& o) {
  for (int i = 0; i < o.dim; ++i) {
    o.force.by_q[i] = -(o.deflection_q[i] * s.stiffness[i] + cd.speed_q[i] * s.damping[i]);
    o.force.by_v[i] = -(o.contact.J[i] * s.damping[i]);
    o.force.by_torque[i] = zero();
    o.JMinv[i] = multiply<J>(o.pass.Minv.row, o.contact.J[i]);
  }
}

}  // namespace pliant::mpc::PLIANT_ISA
