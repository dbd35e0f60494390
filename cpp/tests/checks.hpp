// What the C++ tests of every core share: checks that are counted, a source of numbers, and a count of heap calls.
#pragma once

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <new>

namespace pliant::testing {

inline thread_local int allocations = 0;
inline std::atomic<int> failures{0};

inline void check(bool ok, const char* what, const char* where) {
  if (ok) return;
  ++failures;
  std::printf("FAILED: %s (%s)\n", what, where);
}

// The exit code of a test.
inline int result() {
  const int count = failures;
  std::printf(count ? "%d checks failed\n" : "all checks passed\n", count);
  return count ? 1 : 0;
}

// A deterministic source of numbers in (−1, 1).
struct Noise {
  unsigned state = 1;
  double operator()() {
    state = state * 1664525u + 1013904223u;
    return 2.0 * (state >> 8) / 16777216.0 - 1.0;
  }
};

}  // namespace pliant::testing

// The linker sends every heap call of a test's objects here (CMakeLists.txt), without the C++ library's own calls.
extern "C" {
void* __real_malloc(std::size_t);
void* __real_calloc(std::size_t, std::size_t);
void* __real_realloc(void*, std::size_t);
void* __real_aligned_alloc(std::size_t, std::size_t);
int __real_posix_memalign(void**, std::size_t, std::size_t);
void* __wrap_malloc(std::size_t n) { return ++pliant::testing::allocations, __real_malloc(n); }
void* __wrap_calloc(std::size_t n, std::size_t s) { return ++pliant::testing::allocations, __real_calloc(n, s); }
void* __wrap_realloc(void* p, std::size_t n) { return ++pliant::testing::allocations, __real_realloc(p, n); }
void* __wrap_aligned_alloc(std::size_t a, std::size_t n) {
  return ++pliant::testing::allocations, __real_aligned_alloc(a, n);
}
int __wrap_posix_memalign(void** p, std::size_t a, std::size_t n) {
  return ++pliant::testing::allocations, __real_posix_memalign(p, a, n);
}
}
void* operator new(std::size_t n) {
  ++pliant::testing::allocations;
  if (void* p = __real_malloc(n)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
