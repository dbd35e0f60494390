// Nodes: parameters of all nodes as writable views.
#pragma once
#include <limits>

#include "chain_model.hpp"

namespace pliant::mpc::binding {

struct PyNodes {
  std::vector<NodeData> data;
  int dof;
  ModelData model;

  PyNodes(int count, int n, const ModelData& m) : data(size_t(count)), dof(n), model(m) {
    const double inf = std::numeric_limits<double>::infinity();
    for (NodeData& d : data) {
      d = NodeData{};
      identity(d.task_rotation);
      identity(d.rotation_reference);
      identity(d.anchor_rotation);
      for (int i = 0; i < max_joints; ++i) {
        d.torque_lower[i] = -inf;
        d.torque_upper[i] = inf;
      }
      for (int i = 0; i < max_contact; ++i) {
        d.stiffness[i] = 1e3;  // [N/m]
        d.damping[i] = 1e2;    // [N·s/m]
        d.force_lower[i] = -inf;
        d.force_upper[i] = inf;
      }
      d.friction = inf;
      d.sliding_friction = inf;
      d.contact_active = m.contact_dim > 0;
    }
  }
  void check(double dt) const {
    for (size_t k = 0; k < data.size(); ++k) validate(data[k], int(k), dof, model, dt);
  }
  void copy_node(int source, int target) {
    const int count = int(data.size());
    if (source < 0 || source >= count || target < 0 || target >= count)
      throw std::invalid_argument("copy_node takes nodes 0 to " + std::to_string(count - 1) + ", got " +
                                  std::to_string(source) + " and " + std::to_string(target));
    data[size_t(target)] = data[size_t(source)];
  }
};

// A writable view of one field of all nodes.
template <class T>
nb::object field_view(nb::handle self, T* first, std::vector<size_t> inner) {
  PyNodes& nodes = nb::cast<PyNodes&>(self);
  std::vector<size_t> shape = {nodes.data.size()};
  std::vector<int64_t> strides = {int64_t(sizeof(NodeData) / sizeof(T))};
  int64_t stride = 1;
  for (size_t s : inner) {
    shape.push_back(s);
    stride *= int64_t(s);
  }
  for (size_t s : inner) {
    stride /= int64_t(s > 0 ? s : 1);
    strides.push_back(stride);
  }
  using View = nb::ndarray<nb::numpy, T>;
  return nb::cast(View(first, shape.size(), shape.data(), self, strides.data()), nb::rv_policy::reference);
}

using Shape = std::vector<size_t> (*)(const PyNodes&);

template <class View>
void def_field(nb::class_<PyNodes>& c, const char* name, View view) {
  c.def_prop_rw(
      name, [view](nb::handle self) { return view(self); },
      [view](nb::handle self, nb::object value) { view(self)[nb::ellipsis()] = value; });
}

template <class Member>
void def_array(nb::class_<PyNodes>& c, const char* name, Member member, Shape shape) {
  def_field(c, name, [member, shape](nb::handle self) {
    PyNodes& nodes = nb::cast<PyNodes&>(self);
    return field_view<double>(self, (nodes.data[0].*member), shape(nodes));
  });
}

inline void def_number(nb::class_<PyNodes>& c, const char* name, double NodeData::* member) {
  def_field(c, name, [member](nb::handle self) {
    return field_view<double>(self, &(nb::cast<PyNodes&>(self).data[0].*member), {});
  });
}

inline void bind_nodes(nb::module_& m) {
  const Shape joints = [](const PyNodes& n) { return std::vector<size_t>{size_t(n.dof)}; };
  const Shape state = [](const PyNodes& n) { return std::vector<size_t>{size_t(2 * n.dof)}; };
  const Shape contact = [](const PyNodes& n) { return std::vector<size_t>{size_t(n.model.contact_dim)}; };
  const Shape three = [](const PyNodes&) { return std::vector<size_t>{3}; };
  const Shape six = [](const PyNodes&) { return std::vector<size_t>{6}; };
  const Shape rotation = [](const PyNodes&) { return std::vector<size_t>{3, 3}; };
  nb::class_<PyNodes> c(m, "Nodes");
  c.def(
      "__init__",
      [](PyNodes* self, int count, const PyChain& chain, const PyModel& model) {
        if (count < 1) throw std::invalid_argument("nodes must be one or more, got " + std::to_string(count));
        new (self) PyNodes(count, chain.data.dof, model.data);
      },
      "count"_a, "chain"_a, "model"_a);
  def_array(c, "state_reference", &NodeData::state_reference, state);
  def_array(c, "state_weight", &NodeData::state_weight, state);
  def_array(c, "control_reference", &NodeData::control_reference, joints);
  def_array(c, "control_weight", &NodeData::control_weight, joints);
  def_array(c, "torque_gravity_weight", &NodeData::torque_gravity_weight, joints);
  def_array(c, "control_gravity_weight", &NodeData::control_gravity_weight, joints);
  def_array(c, "task_rotation", &NodeData::task_rotation, rotation);
  def_array(c, "translation_reference", &NodeData::translation_reference, three);
  def_array(c, "translation_weight", &NodeData::translation_weight, three);
  def_array(c, "rotation_reference", &NodeData::rotation_reference, rotation);
  def_array(c, "rotation_weight", &NodeData::rotation_weight, three);
  def_array(c, "velocity_reference", &NodeData::velocity_reference, six);
  def_array(c, "velocity_weight", &NodeData::velocity_weight, six);
  def_array(c, "force_reference", &NodeData::force_reference, contact);
  def_array(c, "force_weight", &NodeData::force_weight, contact);
  def_array(c, "force_rate_weight", &NodeData::force_rate_weight, contact);
  def_array(c, "stiffness", &NodeData::stiffness, contact);
  def_array(c, "damping", &NodeData::damping, contact);
  def_array(c, "anchor_translation", &NodeData::anchor_translation, three);
  def_array(c, "anchor_rotation", &NodeData::anchor_rotation, rotation);
  def_array(c, "torque_lower", &NodeData::torque_lower, joints);
  def_array(c, "torque_upper", &NodeData::torque_upper, joints);
  def_array(c, "force_lower", &NodeData::force_lower, contact);
  def_array(c, "force_upper", &NodeData::force_upper, contact);
  def_number(c, "friction", &NodeData::friction);
  def_number(c, "sliding_friction", &NodeData::sliding_friction);
  def_field(c, "contact_active", [](nb::handle self) {
    return field_view<bool>(self, &nb::cast<PyNodes&>(self).data[0].contact_active, {});
  });
  c.def_prop_ro("count", [](const PyNodes& n) { return n.data.size(); });
  c.def("copy_node", &PyNodes::copy_node, "source"_a, "target"_a);
}

}  // namespace pliant::mpc::binding
