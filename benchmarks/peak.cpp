// Independent multiply-adds on vectors of WIDTH doubles: what benchmarks/mpc_kernel_bound.py calls the core's peak.
typedef double Vector __attribute__((vector_size(8 * WIDTH)));

extern "C" double multiply_add(int repetitions, double factor, double term) {
  constexpr int chains = 12;  // enough to hide the latency, few enough for the registers
  Vector sums[chains];
  for (int i = 0; i < chains; ++i) sums[i] = Vector{} + double(i);
  const Vector a = Vector{} + factor, b = Vector{} + term;
  for (int r = 0; r < repetitions; ++r) {
#pragma GCC unroll 16
    for (int i = 0; i < chains; ++i) sums[i] = sums[i] * a + b;
  }
  double total = 0;
  for (int i = 0; i < chains; ++i)
    for (int k = 0; k < WIDTH; ++k) total += sums[i][k];
  return total;
}

extern "C" int operations() { return 2 * WIDTH * 12; }  // of one repetition
