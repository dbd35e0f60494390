// NumPy's arrays of float64, read where they lie: the buffer protocol and nanobind's own arrays take many times as long
// as reading the numbers of a robot's joints.
#pragma once
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#define NPY_NO_DEPRECATED_API NPY_2_0_API_VERSION
#include <numpy/ndarraytypes.h>

#include <cstddef>
#include <type_traits>

namespace pliant {

namespace nb = nanobind;

// The type of NumPy's arrays; null where this NumPy lays them out otherwise than the one whose headers were compiled.
inline PyTypeObject* known_ndarray() {
  const nb::module_ numpy = nb::module_::import_("numpy");
  const nb::object sample = numpy.attr("zeros")(nb::make_tuple(2, 3));
  const auto* array = reinterpret_cast<const PyArrayObject*>(sample.ptr());
  const nb::object at = sample.attr("__array_interface__")["data"][nb::int_(0)];
  const bool same = PyArray_NDIM(array) == 2 && PyArray_DIMS(array)[0] == 2 && PyArray_DIMS(array)[1] == 3 &&
                    PyArray_STRIDES(array)[0] == 24 && PyArray_STRIDES(array)[1] == 8 &&
                    reinterpret_cast<uintptr_t>(PyArray_DATA(array)) == nb::cast<uintptr_t>(at) &&
                    PyArray_DESCR(array)->type_num == NPY_DOUBLE && PyArray_ISNBO(PyArray_DESCR(array)->byteorder);
  return same ? Py_TYPE(sample.ptr()) : nullptr;
}

// An array of float64 that can be read as it lies; null: something else, a subclass among them.
inline PyArrayObject* doubles_of(nb::handle value) {
  static PyTypeObject* const ndarray = known_ndarray();
  if (Py_TYPE(value.ptr()) != ndarray) return nullptr;
  auto* array = reinterpret_cast<PyArrayObject*>(value.ptr());
  const PyArray_Descr* type = PyArray_DESCR(array);
  const bool plain = type->type_num == NPY_DOUBLE && PyArray_ISNBO(type->byteorder) && PyArray_ISALIGNED(array);
  return plain ? array : nullptr;
}

// The numbers of an argument, side by side in rows. T: double or const double; axes: how many, -1: any. Valid as long
// as the call that it is an argument of.
template <class T, int axes = -1>
class Packed {
 public:
  using Slow =
      std::conditional_t < axes<0, nb::ndarray<T, nb::c_contig, nb::device::cpu>,
                                nb::ndarray<T, nb::ndim<(axes < 0 ? 1 : axes)>, nb::c_contig, nb::device::cpu>>;

  Packed() = default;
  explicit Packed(const Slow& a) : data_(a.data()), size_(a.size()), ndim_(a.ndim()), shape_(a.shape_ptr()), kept_(a) {}

  T* data() const { return data_; }
  size_t size() const { return size_; }
  size_t ndim() const { return ndim_; }
  size_t shape(size_t axis) const { return size_t(shape_[axis]); }

  // False: not to be read as it lies.
  bool look(nb::handle value) {
    PyArrayObject* array = doubles_of(value);
    const int needed = NPY_ARRAY_C_CONTIGUOUS | (std::is_const_v<T> ? 0 : NPY_ARRAY_WRITEABLE);
    if (!array || (PyArray_FLAGS(array) & needed) != needed) return false;
    if (axes >= 0 && PyArray_NDIM(array) != axes) return false;
    data_ = static_cast<T*>(PyArray_DATA(array));
    ndim_ = size_t(PyArray_NDIM(array));
    shape_ = PyArray_DIMS(array);
    size_ = 1;
    for (size_t axis = 0; axis < ndim_; ++axis) size_ *= size_t(shape_[axis]);
    return true;
  }

 private:
  T* data_ = nullptr;
  size_t size_ = 0, ndim_ = 0;
  const int64_t* shape_ = nullptr;
  Slow kept_;
};

}  // namespace pliant

namespace nanobind::detail {

template <class T, int axes>
struct type_caster<pliant::Packed<T, axes>> {
  using Slow = typename pliant::Packed<T, axes>::Slow;
  using Own = pliant::Packed<T, axes>;
  NB_TYPE_CASTER(Own, make_caster<Slow>::Name)

  bool from_python(handle src, uint32_t flags, cleanup_list* cleanup) noexcept {
    if (value.look(src)) return true;
    make_caster<Slow> slow;
    if (!slow.from_python(src, flags, cleanup)) return false;
    value = pliant::Packed<T, axes>(slow.value);
    return true;
  }
};

}  // namespace nanobind::detail
