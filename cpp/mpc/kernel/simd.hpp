// Eight doubles side by side (four in the copy for robots of up to four joints), one lane per joint, on whatever vector
// width the copy is compiled for.
// GCC and Clang vector extensions; every function is forced inline so that no vector type crosses a call.
#pragma once
#include <math.h>
#include <stdint.h>

#if !defined(PLIANT_ISA) || !defined(PLIANT_LANES)
#error "the build defines PLIANT_LANES (8 or 4) and PLIANT_ISA (avx2, avx2_four, ...), the namespace of the copy"
#endif
#define PLIANT_INLINE [[gnu::always_inline]] inline

namespace pliant::mpc::PLIANT_ISA {

constexpr int lane_count = PLIANT_LANES;
#if defined(__AVX512F__)
constexpr int native_width = lane_count;
#elif defined(__AVX__)
constexpr int native_width = 4;
#else
constexpr int native_width = 2;
#endif
constexpr int part_count = lane_count / native_width;

typedef double Native __attribute__((vector_size(8 * native_width)));
typedef int64_t NativeMask __attribute__((vector_size(8 * native_width)));

struct alignas(8 * lane_count) Lanes {
  Native part[part_count];

  PLIANT_INLINE double operator[](int i) const { return part[i / native_width][i % native_width]; }
  PLIANT_INLINE void set(int i, double value) { part[i / native_width][i % native_width] = value; }
  PLIANT_INLINE void add(int i, double value) { set(i, (*this)[i] + value); }
};

#define PLIANT_EACH_PART _Pragma("GCC unroll 4") for (int k = 0; k < part_count; ++k)

PLIANT_INLINE Lanes zero() {
  Lanes r;
  PLIANT_EACH_PART r.part[k] = Native{};
  return r;
}
PLIANT_INLINE Lanes splat(double s) {
  Lanes r;
  PLIANT_EACH_PART r.part[k] = Native{} + s;
  return r;
}
PLIANT_INLINE Lanes operator+(const Lanes& a, const Lanes& b) {
  Lanes r;
  PLIANT_EACH_PART r.part[k] = a.part[k] + b.part[k];
  return r;
}
PLIANT_INLINE Lanes operator-(const Lanes& a, const Lanes& b) {
  Lanes r;
  PLIANT_EACH_PART r.part[k] = a.part[k] - b.part[k];
  return r;
}
PLIANT_INLINE Lanes operator*(const Lanes& a, const Lanes& b) {
  Lanes r;
  PLIANT_EACH_PART r.part[k] = a.part[k] * b.part[k];
  return r;
}
PLIANT_INLINE Lanes operator*(const Lanes& a, double s) {
  Lanes r;
  PLIANT_EACH_PART r.part[k] = a.part[k] * s;
  return r;
}
PLIANT_INLINE Lanes operator*(double s, const Lanes& a) { return a * s; }
PLIANT_INLINE Lanes operator-(const Lanes& a) {
  Lanes r;
  PLIANT_EACH_PART r.part[k] = -a.part[k];
  return r;
}
PLIANT_INLINE Lanes& operator+=(Lanes& a, const Lanes& b) { return a = a + b; }
PLIANT_INLINE Lanes& operator-=(Lanes& a, const Lanes& b) { return a = a - b; }
PLIANT_INLINE Lanes& operator*=(Lanes& a, const Lanes& b) { return a = a * b; }

PLIANT_INLINE Lanes absolute(const Lanes& a) {
  Lanes r;
  PLIANT_EACH_PART r.part[k] = a.part[k] < Native{} ? -a.part[k] : a.part[k];
  return r;
}
PLIANT_INLINE Lanes larger(const Lanes& a, const Lanes& b) {
  Lanes r;
  PLIANT_EACH_PART r.part[k] = a.part[k] > b.part[k] ? a.part[k] : b.part[k];
  return r;
}

template <int... I>
struct Indices {};
template <int N, int... I>
struct MakeIndices : MakeIndices<N - 1, N - 1, I...> {};
template <int... I>
struct MakeIndices<0, I...> {
  using type = Indices<I...>;
};
using NativeIndices = MakeIndices<native_width>::type;

// Lanes S … S + width − 1 of the pair (low, high).
template <int S, int... I>
PLIANT_INLINE Native window(const Native& low, const Native& high, Indices<I...>) {
  return __builtin_shufflevector(low, high, (S + I)...);
}

// Lane i takes lane i + K, zero beyond the end.
template <int K>
PLIANT_INLINE Lanes shift_down(const Lanes& a) {
  constexpr int whole = K / native_width, rest = K % native_width;
  Lanes r;
  PLIANT_EACH_PART {
    const Native low = k + whole < part_count ? a.part[(k + whole) % part_count] : Native{};
    const Native high = k + whole + 1 < part_count ? a.part[(k + whole + 1) % part_count] : Native{};
    r.part[k] = window<rest>(low, high, NativeIndices{});
  }
  return r;
}

// Lane i takes lane i − K, zero before the start.
template <int K>
PLIANT_INLINE Lanes shift_up(const Lanes& a) {
  constexpr int whole = (K + native_width - 1) / native_width, rest = whole * native_width - K;
  Lanes r;
  PLIANT_EACH_PART {
    const int base = k - whole;
    const Native low = base >= 0 ? a.part[base >= 0 ? base : 0] : Native{};
    const Native high = base + 1 >= 0 && base + 1 < part_count ? a.part[base + 1 >= 0 ? base + 1 : 0] : Native{};
    r.part[k] = window<rest>(low, high, NativeIndices{});
  }
  return r;
}

// Σ over the lanes, in the same order whatever the width.
PLIANT_INLINE double sum(const Lanes& a) {
  if constexpr (lane_count == 4) return (a[0] + a[2]) + (a[1] + a[3]);
  return ((a[0] + a[4]) + (a[2] + a[6])) + ((a[1] + a[5]) + (a[3] + a[7]));
}
PLIANT_INLINE double largest(const Lanes& a) {
  double m = a[0];
#pragma GCC unroll 8
  for (int i = 1; i < lane_count; ++i) m = a[i] > m ? a[i] : m;
  return m;
}

// Running sums along the chain: over this joint and all after it (what a joint carries) ...
PLIANT_INLINE Lanes sum_outward(Lanes a) {
  a += shift_down<1>(a);
  a += shift_down<2>(a);
  if constexpr (lane_count > 4) a += shift_down<4>(a);
  return a;
}
// ... and over this joint and all before it (what moves a link).
PLIANT_INLINE Lanes sum_inward(Lanes a) {
  a += shift_up<1>(a);
  a += shift_up<2>(a);
  if constexpr (lane_count > 4) a += shift_up<4>(a);
  return a;
}

alignas(64) constexpr double lane_number[8] = {0, 1, 2, 3, 4, 5, 6, 7};

PLIANT_INLINE Lanes load(const double* p) { return *reinterpret_cast<const Lanes*>(p); }  // aligned like Lanes
PLIANT_INLINE void store(double* p, const Lanes& a) { *reinterpret_cast<Lanes*>(p) = a; }

// Lanes from `first` on are taken from `from`, those before it from `before`.
PLIANT_INLINE Lanes select_from(int first, const Lanes& from, const Lanes& before) {
  const Lanes number = load(lane_number);
  Lanes r;
  PLIANT_EACH_PART r.part[k] = number.part[k] >= Native{} + double(first) ? from.part[k] : before.part[k];
  return r;
}

// Lane i of `a`, zero in the others: what adds to a diagonal without a detour through memory.
PLIANT_INLINE Lanes only(int i, const Lanes& a) {
  const Lanes number = load(lane_number);
  Lanes r;
  PLIANT_EACH_PART r.part[k] = number.part[k] == Native{} + double(i) ? a.part[k] : Native{};
  return r;
}

PLIANT_INLINE double larger(double a, double b) { return a > b ? a : b; }
PLIANT_INLINE int larger(int a, int b) { return a > b ? a : b; }
PLIANT_INLINE double magnitude(double a) { return __builtin_fabs(a); }

}  // namespace pliant::mpc::PLIANT_ISA
