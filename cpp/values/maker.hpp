// Values of a frozen class with slots, made in one call: each field is written into its slot.
#pragma once
#include <nanobind/nanobind.h>
#include <structmember.h>

#include <stdexcept>
#include <unordered_map>
#include <utility>
#include <vector>

namespace pliant::values {

namespace nb = nanobind;

struct Field {
  PyObject* name;     // interned
  Py_ssize_t offset;  // of its slot in a value
  PyObject* given;    // what stands there by default, or what makes it; null: it must be given
  bool made;          // whether `given` makes it
};

// Where a slot lies in a value; `kind` has it by this name.
inline Py_ssize_t slot_of(nb::handle kind, nb::handle name) {
  const nb::object slot = kind.attr(nb::borrow<nb::str>(name));
  if (!PyObject_TypeCheck(slot.ptr(), &PyMemberDescr_Type)) throw std::invalid_argument("a field has no slot");
  return reinterpret_cast<PyMemberDescrObject*>(slot.ptr())->d_member->offset;
}

class Maker {
 public:
  static constexpr size_t kMost = 32;  // fields

  // Args: the class; (name, default or what makes it, whether it is made) of each field, a default of `absent` for
  // none. What they hold lives as long as the class, which is for good.
  Maker(nb::type_object kind, nb::list fields, nb::handle absent) : checks_(nb::hasattr(kind, "__post_init__")) {
    if (fields.size() > kMost) throw std::invalid_argument("too many fields");
    for (nb::handle field : fields) {
      PyObject* name = nb::object(field[0]).release().ptr();
      PyUnicode_InternInPlace(&name);
      nb::object given = field[1];
      const bool none = given.is(absent);
      fields_.push_back({name, slot_of(kind, name), none ? nullptr : given.release().ptr(), nb::cast<bool>(field[2])});
    }
    kind.inc_ref();
  }

  // A value. Null without an error: arguments that do not fit.
  PyObject* make(PyTypeObject* kind, PyObject* const* args, size_t count, PyObject* names) const {
    PyObject* values[kMost] = {};
    if (!sorted(args, count, names, values)) return nullptr;
    PyObject* self = kind->tp_alloc(kind, 0);
    if (!self) return nullptr;
    for (size_t i = 0; i < fields_.size(); ++i) {
      const Field& field = fields_[i];
      PyObject* value = values[i] ? values[i] : field.given;
      value = !values[i] && field.made ? PyObject_CallNoArgs(value) : Py_NewRef(value);
      if (!value) return Py_DECREF(self), nullptr;
      *reinterpret_cast<PyObject**>(reinterpret_cast<char*>(self) + field.offset) = value;
    }
    return checks_ && !checked(self) ? nullptr : self;
  }

 private:
  std::vector<Field> fields_;
  bool checks_;

  // Arguments at the places of their fields. False: one too many, one twice, an unknown one, or one that is missing.
  bool sorted(PyObject* const* args, size_t count, PyObject* names, PyObject** values) const {
    if (count > fields_.size()) return false;
    for (size_t i = 0; i < count; ++i) values[i] = args[i];
    for (Py_ssize_t i = 0; names && i < PyTuple_GET_SIZE(names); ++i) {
      const size_t place = place_of(PyTuple_GET_ITEM(names, i));
      if (place == fields_.size() || values[place]) return false;
      values[place] = args[count + size_t(i)];
    }
    for (size_t i = 0; i < fields_.size(); ++i)
      if (!values[i] && !fields_[i].given) return false;
    return true;
  }
  size_t place_of(PyObject* name) const {
    for (size_t i = 0; i < fields_.size(); ++i)
      if (fields_[i].name == name) return i;
    for (size_t i = 0; i < fields_.size(); ++i)
      if (PyUnicode_Compare(fields_[i].name, name) == 0) return i;
    return fields_.size();
  }
  // False, with an error: the value refuses its fields, and is gone.
  static bool checked(PyObject* self) {
    static PyObject* const name = PyUnicode_InternFromString("__post_init__");
    PyObject* answer = PyObject_CallMethodNoArgs(self, name);
    Py_XDECREF(answer);
    if (!answer) Py_DECREF(self);
    return answer != nullptr;
  }
};

inline std::unordered_map<PyTypeObject*, Maker>& makers() {
  static std::unordered_map<PyTypeObject*, Maker> known;
  return known;
}

// By the class's own `__init__`, which says what is wrong with its arguments.
inline PyObject* by_init(PyObject* kind, PyObject* const* args, size_t count, PyObject* names) {
  nb::object all = nb::steal(PyTuple_New(Py_ssize_t(count))), named = nb::steal(PyDict_New());
  if (!all.is_valid() || !named.is_valid()) return nullptr;
  for (size_t i = 0; i < count; ++i) PyTuple_SET_ITEM(all.ptr(), Py_ssize_t(i), Py_NewRef(args[i]));
  for (Py_ssize_t i = 0; names && i < PyTuple_GET_SIZE(names); ++i)
    if (PyDict_SetItem(named.ptr(), PyTuple_GET_ITEM(names, i), args[count + size_t(i)]) < 0) return nullptr;
  return PyType_Type.tp_call(kind, all.ptr(), named.ptr());
}

// What Python calls where a class is called.
inline PyObject* construct(PyObject* kind, PyObject* const* args, size_t flags, PyObject* names) {
  auto* type = reinterpret_cast<PyTypeObject*>(kind);
  const size_t count = size_t(PyVectorcall_NARGS(flags));
  const auto known = makers().find(type);
  if (known != makers().end()) {
    PyObject* made = known->second.make(type, args, count, names);
    if (made || PyErr_Occurred()) return made;
  }
  return by_init(kind, args, count, names);
}

inline void make_by_slots(nb::type_object kind, nb::list fields, nb::handle absent) {
  auto* type = reinterpret_cast<PyTypeObject*>(kind.ptr());
  makers().insert_or_assign(type, Maker(kind, std::move(fields), absent));
  type->tp_vectorcall = construct;
}

}  // namespace pliant::values
