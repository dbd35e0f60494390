// Copies of frozen values with some fields changed.
#pragma once
#include <string>
#include <unordered_map>
#include <vector>

#include "maker.hpp"

namespace pliant::values {

// The slots of a class.
class Slots {
 public:
  explicit Slots(nb::handle kind) {
    for (nb::handle name : nb::borrow<nb::tuple>(kind.attr("__slots__"))) {
      PyObject* kept = nb::borrow(name).release().ptr();
      PyUnicode_InternInPlace(&kept);
      places_.push_back({kept, slot_of(kind, kept)});
    }
    kind.inc_ref();  // it is known for good
  }

  PyObject* copy(PyObject* value) const {
    PyTypeObject* kind = Py_TYPE(value);
    PyObject* made = kind->tp_alloc(kind, 0);
    for (size_t i = 0; made && i < places_.size(); ++i) {
      PyObject* part = at(value, places_[i].offset);
      if (part) at(made, places_[i].offset) = Py_NewRef(part);
    }
    return made;
  }

  // False: there is no such slot.
  bool write(PyObject* value, PyObject* name, PyObject* part) const {
    const Place* place = place_of(name);
    if (!place) return false;
    PyObject*& slot = at(value, place->offset);
    PyObject* before = slot;
    slot = Py_NewRef(part);
    Py_XDECREF(before);
    return true;
  }

 private:
  struct Place {
    PyObject* name;  // interned
    Py_ssize_t offset;
  };
  std::vector<Place> places_;

  static PyObject*& at(PyObject* value, Py_ssize_t offset) {
    return *reinterpret_cast<PyObject**>(reinterpret_cast<char*>(value) + offset);
  }
  const Place* place_of(PyObject* name) const {
    for (const Place& place : places_)
      if (place.name == name) return &place;
    for (const Place& place : places_)
      if (PyUnicode_Compare(place.name, name) == 0) return &place;
    return nullptr;
  }
};

inline nb::object changed(nb::handle value, const nb::kwargs& fields) {
  static std::unordered_map<PyTypeObject*, Slots> known;
  PyTypeObject* kind = Py_TYPE(value.ptr());
  auto slots = known.find(kind);
  if (slots == known.end()) slots = known.emplace(kind, Slots(nb::handle(reinterpret_cast<PyObject*>(kind)))).first;
  nb::object made = nb::steal(slots->second.copy(value.ptr()));
  if (!made.is_valid()) throw nb::python_error();
  PyObject *name = nullptr, *part = nullptr;
  for (Py_ssize_t at = 0; PyDict_Next(fields.ptr(), &at, &name, &part);)
    if (!slots->second.write(made.ptr(), name, part)) {
      const std::string text = std::string(kind->tp_name) + " has no field " + nb::cast<std::string>(nb::handle(name));
      throw nb::attribute_error(text.c_str());
    }
  return made;
}

}  // namespace pliant::values
