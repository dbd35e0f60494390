// Views of an array: parts of its numbers as arrays of their own, without a copy.
#pragma once
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

#include "../shared/numpy_new.hpp"

namespace pliant::values {

namespace nb = nanobind;

// (where a part begins, its shape…)
using Place = std::vector<npy_intp>;

inline npy_intp end_of(const Place& place) {
  npy_intp size = 1;
  for (size_t axis = 1; axis < place.size(); ++axis) size *= place[axis];
  return place[0] + size;
}

// How many numbers an array needs for these places. They are of one axis or two.
inline npy_intp needed(const std::vector<Place>& places) {
  npy_intp end = 0;
  for (const Place& place : places) {
    if (place.size() < 2 || *std::min_element(place.begin(), place.end()) < 0)
      throw std::invalid_argument("a place is where it begins, and its shape");
    end = std::max(end, end_of(place));
  }
  return end;
}

// The array that holds the numbers: a vector, side by side, of at least so many.
inline PyArrayObject* holder_of(nb::handle numbers, npy_intp size) {
  PyArrayObject* array = doubles_of(numbers);
  if (!array || PyArray_NDIM(array) != 1 || !PyArray_IS_C_CONTIGUOUS(array) || PyArray_DIMS(array)[0] < size)
    throw std::invalid_argument("the numbers must be a vector of float64, side by side, with every place in it");
  return array;
}

inline nb::object view(PyArrayObject* of, const Place& place) {
  return view_of(of, int(place.size()) - 1, place.data() + 1, nullptr, place[0]);
}

// Several views of an array.
class Views {
 public:
  explicit Views(std::vector<Place> places) : places_(std::move(places)), size_(needed(places_)) {}

  npy_intp size() const { return size_; }
  nb::object of(nb::handle numbers) const {
    PyArrayObject* array = holder_of(numbers, size_);
    nb::object made = nb::steal(PyTuple_New(Py_ssize_t(places_.size())));
    if (!made.is_valid()) throw nb::python_error();
    for (size_t i = 0; i < places_.size(); ++i)
      PyTuple_SET_ITEM(made.ptr(), Py_ssize_t(i), view(array, places_[i]).release().ptr());
    return made;
  }

 private:
  std::vector<Place> places_;
  npy_intp size_;
};

// The same by name.
class NamedViews {
 public:
  NamedViews(std::vector<nb::str> names, std::vector<Place> places)
      : names_(std::move(names)), places_(std::move(places)), size_(needed(places_)) {
    if (names_.size() != places_.size()) throw std::invalid_argument("each name has a place");
  }

  nb::dict of(nb::handle numbers) const {
    nb::dict made;
    if (!places_.empty()) into(numbers, made);
    return made;
  }
  void into(nb::handle numbers, nb::dict named) const {
    PyArrayObject* array = holder_of(numbers, size_);
    for (size_t i = 0; i < places_.size(); ++i)
      if (PyDict_SetItem(named.ptr(), names_[i].ptr(), view(array, places_[i]).ptr()) < 0) throw nb::python_error();
  }

 private:
  std::vector<nb::str> names_;
  std::vector<Place> places_;
  npy_intp size_;
};

}  // namespace pliant::values
