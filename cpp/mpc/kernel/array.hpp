// Memory taken once, and the clock.
#pragma once
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

namespace pliant::mpc::PLIANT_ISA {

inline double now_seconds() {
  timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

// An array of T in memory aligned for the widest vectors; lives as long as its owner.
template <class T>
struct Array {
  T* data = nullptr;
  int count = 0;

  Array() = default;
  Array(const Array&) = delete;
  Array& operator=(const Array&) = delete;
  ~Array() { free(data); }
  bool allocate(int n) {
    count = n;
    data = static_cast<T*>(aligned_alloc(64, (sizeof(T) * size_t(n) + 63) / 64 * 64));
    if (data) memset(static_cast<void*>(data), 0, sizeof(T) * size_t(n));
    return data != nullptr;
  }
  T& operator[](int i) { return data[i]; }
  const T& operator[](int i) const { return data[i]; }
};

}  // namespace pliant::mpc::PLIANT_ISA
