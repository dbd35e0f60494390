// A controller's state as bytes and back, for copies that leave the process.
#pragma once
#include <cstring>
#include <string>
#include <type_traits>

#include "../step/state.hpp"
#include "chain_model.hpp"

namespace pliant::mpc::binding {

class Writer {
 public:
  template <class T>
  void value(const T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes.append(reinterpret_cast<const char*>(&v), sizeof v);
  }
  template <class T>
  void series(const std::vector<T>& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    value(v.size());
    bytes.append(reinterpret_cast<const char*>(v.data()), v.size() * sizeof(T));
  }
  std::string bytes;
};

class Reader {
 public:
  explicit Reader(const std::string& bytes) : at_(bytes.data()), left_(bytes.size()) {}

  template <class T>
  void value(T& v) {
    take(&v, sizeof v);
  }
  template <class T>
  void series(std::vector<T>& v) {
    size_t count = 0;
    value(count);
    if (count > left_ / sizeof(T)) refuse();
    v.resize(count);
    take(v.data(), count * sizeof(T));
  }
  void finish() const {
    if (left_) refuse();
  }

 private:
  const char* at_;
  size_t left_;

  [[noreturn]] static void refuse() {
    throw std::invalid_argument("these bytes are no state of a predictive controller of this version");
  }
  void take(void* to, size_t count) {
    if (count > left_) refuse();
    std::memcpy(to, at_, count);
    at_ += count;
    left_ -= count;
  }
};

constexpr size_t state_layout = sizeof(step::Memory) ^ (sizeof(NodeData) << 12) ^ (sizeof(ChainData) << 24);

// Writes or reads everything that a state is made of, in one order.
template <class Stream, class Memory, class Series, class Kept, class Chain, class Model, class Opts, class Tick>
void all_of(Stream& stream, Memory& m, Series& s, Kept& k, Chain& chain, Model& model, Opts& options, Tick& tick) {
  stream.value(chain);
  stream.value(model);
  stream.value(options);
  stream.value(tick);
  stream.value(m);
  for (auto* values : {&s.torques, &s.gain, &s.commands, &s.wanted, &s.path, &s.forces}) stream.series(*values);
  stream.series(s.nodes);
  stream.series(s.phases);
  for (auto* values : {&k.xs, &k.us, &k.multipliers}) stream.series(*values);
}

inline std::string to_bytes(const step::State& state) {
  Writer writer;
  writer.value(state_layout);
  const step::Kept kept = state.kept();
  all_of(writer, state.memory, state.series, kept, state.chain, state.model, state.options, state.tick);
  return std::move(writer.bytes);
}

struct StateParts {
  step::Memory memory;
  step::Series series;
  step::Kept kept;
  ChainData chain;
  ModelData model;
  Options options;
  double tick;
};

// Whether the sizes belong together, so that no step reads beyond an end.
inline bool consistent(const StateParts& p) {
  if (p.chain.dof < 1 || p.chain.dof > max_joints || p.model.contact_dim < 0 || p.model.contact_dim > max_contact ||
      p.options.horizon < 1)
    return false;
  const size_t n = size_t(p.chain.dof), N = size_t(p.options.horizon), nx = size_t(state_dim(p.model, p.chain.dof));
  const step::Series& s = p.series;
  return s.torques.size() == N * n && s.gain.size() == n * nx && s.path.size() == 3 * (N + 1) &&
         s.forces.size() == N * size_t(p.model.contact_dim) && s.nodes.size() == N + 1 && s.phases.size() == N + 1 &&
         s.commands.size() % n == 0 && s.wanted.size() % n == 0 && p.kept.xs.size() == (N + 1) * nx &&
         p.kept.us.size() == N * n &&
         p.kept.multipliers.size() == (p.options.bounds ? (N + 1) * multipliers_per_node : 0);
}

inline StateParts from_bytes(const std::string& bytes) {
  Reader reader(bytes);
  size_t layout = 0;
  StateParts p{};
  reader.value(layout);
  if (layout != state_layout)
    throw std::invalid_argument("these bytes are no state of a predictive controller of this version");
  all_of(reader, p.memory, p.series, p.kept, p.chain, p.model, p.options, p.tick);
  reader.finish();
  if (!consistent(p)) throw std::invalid_argument("these bytes are no state of a predictive controller");
  return p;
}

}  // namespace pliant::mpc::binding
