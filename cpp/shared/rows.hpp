// Rows of somebody's numbers.
#pragma once

namespace pliant {

// Rows of numbers that belong to the caller; a row's own numbers lie side by side.
struct Rows {
  const double* data = nullptr;  // null: there are none
  long stride = 0;               // numbers from one row to the next

  const double* row(int i) const { return data + i * stride; }
};

}  // namespace pliant
