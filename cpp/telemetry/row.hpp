// A tick as a row of numbers: which numbers stand where in the row, and what a tick must be like to have that row.
#pragma once
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "../shared/python_signals.hpp"

namespace pliant::telemetry {

// A place in a tick, with all that lies below it.
struct Place {
  enum class Kind { fields, mapping, items, none, text, array, number };

  Kind kind = Kind::fields;
  nb::object name;            // by which the place above has it: an attribute or a key
  nb::object said;            // the text that must stand here
  std::vector<Place> inside;  // attributes, or every key or item in order
  mutable nb::object layout;  // of a mapping whose numbers lie in one array, once it was read
  int offset = 0, size = 1;   // of the numbers in the row
};

// A step of a path: the name of an attribute, a tuple of the key of a mapping, or the index of an item.
using Path = nb::tuple;

class Row {
 public:
  // Args: the class of mappings whose numbers lie in one array (src/pliant/flat_channels.py).
  explicit Row(nb::object flat) : flat_(std::move(flat)) {}

  // A mapping of these keys in this order; what stands at them is added later.
  void mapping(Path path, nb::tuple keys) {
    Place& place = at(path);
    place.kind = Place::Kind::mapping;
    for (nb::handle key : keys) place.inside.emplace_back().name = nb::borrow(key);
  }
  // A tuple of so many items.
  void items(Path path, int count) {
    Place& place = at(path);
    place.kind = Place::Kind::items;
    place.inside.resize(size_t(count));
  }
  void none(Path path) { at(path).kind = Place::Kind::none; }
  void text(Path path, nb::str said) {
    Place& place = at(path);
    place.kind = Place::Kind::text;
    place.said = std::move(said);
  }
  void array(Path path, int offset, int size) { numbers(path, Place::Kind::array, offset, size); }
  void number(Path path, int offset) { numbers(path, Place::Kind::number, offset, 1); }
  int width() const { return width_; }

  // Fills a row. Returns -1, or the offset of the numbers that do not fit, `width` where it is something else; the row
  // is undefined then.
  int fill(nb::handle tick, double* row) const {
    const int failed = visit(top_, tick, row);
    if (failed != fits && PyErr_Occurred()) {
      if (!PyErr_ExceptionMatches(PyExc_Exception)) throw nb::python_error();
      PyErr_Clear();
    }
    return failed;
  }

 private:
  static constexpr int fits = -1;

  Place top_;
  int width_ = 0;
  nb::object flat_, layout_ = nb::str("layout"), numbers_ = nb::str("numbers");

  Place& at(Path path) {
    Place* place = &top_;
    for (nb::handle step : path) place = PyLong_Check(step.ptr()) ? item(*place, step) : &named(*place, step);
    return *place;
  }
  static Place* item(Place& place, nb::handle index) { return &place.inside.at(size_t(nb::cast<int>(index))); }
  static Place& named(Place& place, nb::handle step) {
    const bool is_key = PyTuple_Check(step.ptr());
    const nb::object name = is_key ? nb::object(step[0]) : nb::borrow(step);
    for (Place& known : place.inside)
      if (same_text(known.name, name)) return known;
    if (is_key) throw std::invalid_argument("a mapping's keys must be told before what stands at them");
    Place& made = place.inside.emplace_back();
    made.name = name;
    PyObject* interned = made.name.release().ptr();
    PyUnicode_InternInPlace(&interned);
    made.name = nb::steal(interned);
    return made;
  }
  void numbers(Path path, Place::Kind kind, int offset, int size) {
    Place& place = at(path);
    place.kind = kind;
    place.offset = offset;
    place.size = size;
    width_ = std::max(width_, offset + size);
  }

  int visit(const Place& place, nb::handle value, double* row) const {
    switch (place.kind) {
      case Place::Kind::fields:
        return visit_fields(place, value, row);
      case Place::Kind::mapping:
        return PyDict_CheckExact(value.ptr()) ? visit_dict(place, value, row) : visit_mapping(place, value, row);
      case Place::Kind::items:
        return visit_items(place, value, row);
      case Place::Kind::none:
        return value.is_none() ? fits : width_;
      case Place::Kind::text:
        return same_text(value, place.said) ? fits : width_;
      case Place::Kind::array:
        return copy_array(value, place.size, row + place.offset) ? fits : place.offset;
      case Place::Kind::number:
        return copy_number(value, row + place.offset) ? fits : place.offset;
    }
    return width_;
  }
  int visit_fields(const Place& place, nb::handle value, double* row) const {
    for (const Place& field : place.inside) {
      const nb::object found = nb::steal(PyObject_GetAttr(value.ptr(), field.name.ptr()));
      if (!found.is_valid()) return width_;
      if (const int failed = visit(field, found, row); failed != fits) return failed;
    }
    return fits;
  }
  int visit_items(const Place& place, nb::handle value, double* row) const {
    if (!PyTuple_Check(value.ptr()) || PyTuple_GET_SIZE(value.ptr()) != Py_ssize_t(place.inside.size())) return width_;
    for (size_t i = 0; i < place.inside.size(); ++i)
      if (const int failed = visit(place.inside[i], PyTuple_GET_ITEM(value.ptr(), i), row); failed != fits)
        return failed;
    return fits;
  }
  int visit_dict(const Place& place, nb::handle value, double* row) const {
    if (PyDict_GET_SIZE(value.ptr()) != Py_ssize_t(place.inside.size())) return width_;
    Py_ssize_t next = 0;
    PyObject *key, *found;
    for (const Place& entry : place.inside) {
      if (!PyDict_Next(value.ptr(), &next, &key, &found) || !same_text(entry.name, key)) return width_;
      const nb::object kept = nb::borrow(found);
      if (const int failed = visit(entry, kept, row); failed != fits) return failed;
    }
    return fits;
  }
  // Another mapping. One whose numbers lie in one array is read number by number the first time, and copied as it lies
  // where it has the same layout then.
  int visit_mapping(const Place& place, nb::handle value, double* row) const {
    if (!value.type().is(flat_)) return visit_keys(place, value, row);
    const nb::object layout = value.attr(layout_);
    if (place.layout.is(layout)) {
      const nb::object numbers = value.attr(numbers_);
      if (copy_flat(place, doubles_of(numbers), row)) return fits;
    }
    const int failed = visit_keys(place, value, row);
    if (failed == fits) place.layout = layout;
    return failed;
  }
  // False: there are not as many numbers as the mapping's values have.
  static bool copy_flat(const Place& place, const PyArrayObject* array, double* row) {
    if (!array || PyArray_NDIM(array) != 1 || !PyArray_IS_C_CONTIGUOUS(array)) return false;
    npy_intp size = 0;
    for (const Place& entry : place.inside) size += entry.size;
    if (PyArray_DIMS(array)[0] != size) return false;
    const auto* from = static_cast<const double*>(PyArray_DATA(array));
    for (const Place& entry : place.inside) {
      std::memcpy(row + entry.offset, from, size_t(entry.size) * sizeof(double));
      from += entry.size;
    }
    return true;
  }
  int visit_keys(const Place& place, nb::handle value, double* row) const {
    const nb::object keys = nb::steal(PySequence_Tuple(value.ptr()));
    if (!keys.is_valid() || PyTuple_GET_SIZE(keys.ptr()) != Py_ssize_t(place.inside.size())) return width_;
    for (size_t i = 0; i < place.inside.size(); ++i) {
      const Place& entry = place.inside[i];
      if (!same_text(entry.name, PyTuple_GET_ITEM(keys.ptr(), i))) return width_;
      const nb::object found = nb::steal(PyObject_GetItem(value.ptr(), entry.name.ptr()));
      if (!found.is_valid()) return width_;
      if (const int failed = visit(entry, found, row); failed != fits) return failed;
    }
    return fits;
  }

  // Every number in the order of C, whatever the steps between them.
  static double* copied(const PyArrayObject* array, int axis, const char* from, double* to) {
    if (axis == PyArray_NDIM(array)) {
      *to = *reinterpret_cast<const double*>(from);
      return to + 1;
    }
    const npy_intp step = PyArray_STRIDES(array)[axis];
    for (npy_intp i = 0; i < PyArray_DIMS(array)[axis]; ++i) to = copied(array, axis + 1, from + i * step, to);
    return to;
  }
  static bool copy_array(nb::handle value, int size, double* to) {
    PyArrayObject* array = doubles_of(value);
    if (!array) return convert(value, size, true, to);
    npy_intp count = 1;
    for (int axis = 0; axis < PyArray_NDIM(array); ++axis) count *= PyArray_DIMS(array)[axis];
    if (count != size) return false;
    if (PyArray_IS_C_CONTIGUOUS(array))
      std::memcpy(to, PyArray_DATA(array), size_t(size) * sizeof(double));
    else
      copied(array, 0, PyArray_BYTES(array), to);
    return true;
  }
  static bool copy_number(nb::handle value, double* to) {
    if (PyFloat_Check(value.ptr())) {
      *to = PyFloat_AS_DOUBLE(value.ptr());
      return true;
    }
    if (!PyLong_Check(value.ptr())) return convert(value, 1, false, to);
    *to = PyLong_AsDouble(value.ptr());
    return *to != -1.0 || !PyErr_Occurred();
  }
  // Numbers of another kind: integers, truths, floats of another size.
  static bool convert(nb::handle value, int size, bool is_array, double* to) {
    try {
      const nb::module_ numpy = nb::module_::import_("numpy");
      const nb::object given = numpy.attr("asarray")(value);
      if (nb::cast<int>(given.attr("size")) != size || (!is_array && nb::cast<int>(given.attr("ndim")) != 0))
        return false;
      if (std::strchr("fiub", nb::cast<const char*>(given.attr("dtype").attr("kind"))[0]) == nullptr) return false;
      const nb::object made = numpy.attr("ascontiguousarray")(given, "dtype"_a = "float64");
      std::memcpy(to, nb::cast<Packed<const double>>(made).data(), size_t(size) * sizeof(double));
      return true;
    } catch (nb::python_error& error) {
      error.restore();
      return false;
    }
  }
};

}  // namespace pliant::telemetry
