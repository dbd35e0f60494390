// Extension module pliant._estimation.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "../shared/contract.hpp"
#include "bind_chain.hpp"
#include "bind_part.hpp"
#include "bind_stages.hpp"

using namespace pliant::estimation;

NB_MODULE(_estimation, m) {
  pliant::agree(m, "_estimation");
  bind_stages(m);
  bind_chain(m);
  bind_part(m);
}
