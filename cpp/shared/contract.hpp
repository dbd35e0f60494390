// Whether a compiled module belongs to the Python beside it: src/pliant/contract.py says how.
#pragma once
#include <nanobind/nanobind.h>

#include <stdexcept>

namespace pliant {

// Numbers of the module's face and of the headers in this folder. CMake writes them, for each module its own.
extern const char* const kFace;
extern const char* const kShared;

// The first thing that a module does. If it is of another version its import fails with the sentence that Python says.
inline void agree(nanobind::module_& module, const char* name) {
  module.attr("__contract__") = nanobind::make_tuple(kFace, kShared);
  try {
    nanobind::module_::import_("pliant.contract").attr("agree")(name, kFace, kShared);
  } catch (nanobind::python_error& error) {
    throw std::runtime_error(nanobind::str(error.value()).c_str());
  }
}

}  // namespace pliant
