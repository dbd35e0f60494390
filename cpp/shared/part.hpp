// Parts of a control loop that run without Python. All numbers of a tick lie in one row; a part was told when it was
// made where its own are and where those are that it reads. What it remembers lies in a row of its own.
#pragma once

namespace pliant {

// An estimator or a controller: reads numbers of a tick's row and writes others.
class Part {
 public:
  Part() = default;
  Part(const Part&) = delete;
  Part& operator=(const Part&) = delete;
  virtual ~Part() = default;

  virtual int memory_size() const { return 0; }  // numbers that it remembers
  // False: Python has to look at this tick. What is written and remembered is of no use then.
  virtual bool step(double* row, double* memory) = 0;
  // A part that keeps something beyond its memory: a block begins; the block begins again.
  virtual void begin() {}
  virtual void rewind() {}
  // A part outside sent that much less than the torque (n) [N m] that was asked for.
  virtual void kept_back(double*, const double*) const {}
};

// A simulated robot in its world, whose state is its own.
class World {
 public:
  World() = default;
  World(const World&) = delete;
  World& operator=(const World&) = delete;
  virtual ~World() = default;

  // Writes what is true now.
  virtual void tell(double* row) const = 0;
  // Holds the command of a tick for a period; writes the measurement into the next row. False: the robot stopped.
  virtual bool step(const double* row, double* next) = 0;
};

// Numbers of a row.
struct Span {
  int begin = 0, size = 0;
};

}  // namespace pliant
